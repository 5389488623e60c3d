"""All windows of all trials at once, against a least-squares solution for each, in one run."""

from time import perf_counter

import numpy as np

from labsim.surface_motion import motion_fit

TRIALS, WINDOWS = 100, 120
TIME = np.arange(0.25, 60, 0.5)
RNG = np.random.default_rng(71)
POINTS = 12 * TIME[:, None] * [1.0, 0.2] + RNG.normal(scale=20.0, size=(TRIALS, WINDOWS, 2))


def one_by_one(points):
    """The velocity known at each window of one trial, the plain way."""
    velocity = np.full(points.shape, np.nan)
    for k in range(2, len(points) + 1):
        columns = np.stack([np.ones(k), TIME[:k]], axis=-1)
        velocity[k - 1] = np.linalg.lstsq(columns, points[:k], rcond=None)[0][1]
    return velocity


def median_seconds(call, rounds):
    times = []
    for _ in range(rounds):
        begin = perf_counter()
        call()
        times.append(perf_counter() - begin)
    return float(np.median(times))


def test_fitting_all_trials_at_once_is_ten_times_faster_than_one_by_one(benchmark):
    np.testing.assert_allclose(motion_fit(POINTS[3], TIME).velocity, one_by_one(POINTS[3]), rtol=1e-6)
    slow = median_seconds(lambda: one_by_one(POINTS[0]), 5)
    fast = median_seconds(lambda: motion_fit(POINTS, TIME), 9) / TRIALS
    benchmark.extra_info["times faster for one trial"] = round(slow / fast)
    benchmark(motion_fit, POINTS, TIME)
    assert slow / fast > 10
