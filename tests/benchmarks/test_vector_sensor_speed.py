"""The fast sampler against making waveforms and walking through their windows, in one run."""

from time import perf_counter

import numpy as np

from labsim.vector_sensor import PassingVessel, averaged_intensity, record, sample_intensity

TRIALS = 200


def loop_over_windows(scenario, rng):
    """One trial the plain way: four waveforms, then the mean product of every window in turn."""
    heard = record(scenario, rng)
    length = scenario.samples_per_window
    intensity = []
    for start in range(0, scenario.windows * length, length):
        window = slice(start, start + length)
        intensity.append(averaged_intensity(heard.pressure[window], heard.velocity[window], length)[0])
    return np.array(intensity)


def median_seconds(call, rounds):
    times = []
    for _ in range(rounds):
        begin = perf_counter()
        call()
        times.append(perf_counter() - begin)
    return float(np.median(times))


def test_the_fast_sampler_is_five_hundred_times_faster_than_the_waveforms(benchmark):
    vessel, rng = PassingVessel(), np.random.default_rng(70)
    slow = median_seconds(lambda: loop_over_windows(vessel, rng), 3)
    fast = median_seconds(lambda: sample_intensity(vessel, rng, TRIALS), 9) / TRIALS
    benchmark.extra_info["times faster for one trial"] = round(slow / fast)
    benchmark(sample_intensity, vessel, rng, TRIALS)
    assert slow / fast > 500
