"""A thousand loops at once against one loop in plain Python, both drawing their own noise."""

import math

import numpy as np
import pytest

from labsim.delay_tracking import Loop, loop_gain, track
from labsim.discriminator import BasebandObserver, Pair, curve_slope

PAIR = Pair()
LOOP = Loop(0.2)
STEPS, TRIALS, SCALAR_STEPS = 250, 1000, 5000
TIMES = {}


def batched(rng, steps=STEPS, trials=TRIALS):
    observer = BasebandObserver(PAIR, np.zeros(steps), rng.standard_normal((1, steps, trials)))
    return track(observer, PAIR, LOOP)


def scalar(rng, steps=SCALAR_STEPS):
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


def test_both_loops_have_the_same_jitter():
    # 2,000 and 250 time constants: standard errors 1.1 % and 4.5 % of the deviation.
    one = scalar(np.random.default_rng(1), 25_000)
    many = batched(np.random.default_rng(2))
    assert np.std(one[250:]) == pytest.approx(np.std(many[200:]), rel=0.15)


@pytest.mark.parametrize("run, trial_steps", [(batched, STEPS * TRIALS), (scalar, SCALAR_STEPS)])
def test_time_of_a_trial_step(benchmark, run, trial_steps):
    rng = np.random.default_rng(3)
    benchmark.pedantic(run, args=(rng,), rounds=15, warmup_rounds=1)
    TIMES[run] = benchmark.stats["median"] / trial_steps
    benchmark.extra_info["ns_per_trial_step"] = 1e9 * TIMES[run]


def test_a_thousand_loops_at_once_are_twenty_times_faster():
    if len(TIMES) < 2:
        pytest.skip("the two timings were not run")
    assert TIMES[scalar] / TIMES[batched] >= 20
