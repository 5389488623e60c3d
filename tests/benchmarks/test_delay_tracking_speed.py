"""A thousand loops at once against one loop in plain Python, both drawing their own noise, in one run."""

import math
from time import perf_counter

import numpy as np
import pytest

from labsim.delay_tracking import Loop, loop_gain, track
from labsim.discriminator import BasebandObserver, Pair, curve_slope

PAIR = Pair()
LOOP = Loop(0.2)
TRIALS, STEPS = 1000, 25  # short: a thousand loops' noise stays in the processor's cache
SCALAR_STEPS = 5000


def batched(rng, steps):
    observer = BasebandObserver(PAIR, np.zeros(steps), rng.standard_normal((1, steps, TRIALS)))
    return track(observer, PAIR, LOOP)


def scalar(rng, steps):
    """The same loop for one trial, a number at a time."""
    angular, ratio = PAIR.angular_frequency, PAIR.noise_ratio
    height = curve_slope(PAIR) / angular
    scale = math.sqrt(2 / (math.pi**2 * PAIR.centre_frequency**2 * PAIR.bandwidth) / PAIR.step)
    gain, delay, estimate = loop_gain(PAIR, LOOP.time_constant), 0.0, []
    for _ in range(steps):
        estimate.append(delay)
        sine = math.sin(-angular * delay)
        spread = math.sqrt(ratio * (ratio + 2) + 2 * sine * sine)
        delay += PAIR.step * gain * (height * sine + scale * spread * rng.standard_normal())
    return np.array(estimate)


def seconds(function, *arguments):
    begin = perf_counter()
    function(*arguments)
    return perf_counter() - begin


def test_both_loops_have_the_same_jitter():
    # 2,000 and 250 time constants: standard errors 1.1 % and 4.5 % of the deviation.
    one = scalar(np.random.default_rng(1), 25_000)
    many = batched(np.random.default_rng(2), 250)
    assert np.std(one[250:]) == pytest.approx(np.std(many[200:]), rel=0.15)


def test_a_thousand_loops_at_once_are_many_times_faster(benchmark):
    # Turn by turn, the best of 40: what else the machine does only adds to a time. The ratio depends on the
    # processor, 18 to 31 on those tried; half of what is left to the batch goes into sine and noise.
    rng = np.random.default_rng(3)
    times = [(seconds(scalar, rng, SCALAR_STEPS), seconds(batched, rng, STEPS)) for _ in range(40)]
    slow, fast = np.min(times, axis=0) / (SCALAR_STEPS, STEPS * TRIALS)
    benchmark.extra_info["ns per step of one loop"] = {"batched": 1e9 * fast, "scalar": 1e9 * slow}
    benchmark(batched, rng, STEPS)
    assert slow / fast >= 10
