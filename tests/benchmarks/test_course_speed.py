"""Notebook 06: the field of the full scene, all modes at once, and the running estimate of many trials."""

import time
import tracemalloc

import numpy as np
import pytest
from test_course import loop_course

from labsim.course import Passage, bearing_and_range, paper_course, simulate_observations
from labsim.waveguide import HorizontalArray, PekerisWaveguide, array_field, pressure, solve_modes

SEA, ARRAY, PASSAGE = PekerisWaveguide(), HorizontalArray(), Passage()


def seconds(function, *arguments):
    start = time.perf_counter()
    function(*arguments)
    return time.perf_counter() - start


def test_the_full_scene_in_500_mib(benchmark):
    """1,172 frames x 64 receivers x 410 frequencies; the median is to stay below 5 s on two cores.

    Against one direct sum for each receiver, timed for two of the 64 receivers in the same run.
    """
    modes = solve_modes(SEA, ARRAY.frequency)
    bearing, distance = bearing_and_range(PASSAGE.track, PASSAGE.time)
    tracemalloc.start()
    field = array_field(modes, ARRAY, distance, bearing)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert field.shape == (1172, 64, 410) and peak <= 500 * 2**20
    del field
    benchmark.pedantic(array_field, (modes, ARRAY, distance, bearing), rounds=3)
    direct = 32 * min(seconds(lambda: [pressure(modes, distance) for _ in range(2)]) for _ in range(2))
    benchmark.extra_info.update(peak_mib=round(peak / 2**20), times_direct=direct / benchmark.stats["median"])
    assert direct / benchmark.stats["median"] > 3


def test_the_running_estimate_of_100_trials_beats_a_plain_loop_fifty_times(benchmark):
    """The loop runs 4 of the 100 trials and is scaled by 25; both in one run on one machine."""
    bearing, distance = bearing_and_range(PASSAGE.track, PASSAGE.time)
    ratio = distance / distance[0]
    trials = simulate_observations(np.random.default_rng(1), bearing, ratio, 0.01, 0.05, 100)
    benchmark(paper_course, *trials, 0.01, 0.05)
    loop = 25 * seconds(lambda: [loop_course(trials[0][n], trials[1][n], 0.01, 0.05) for n in range(4)])
    benchmark.extra_info["times_plain_loop"] = loop / benchmark.stats["median"]
    assert loop / benchmark.stats["median"] >= 50


def test_all_modes_at_all_frequencies_against_an_independent_code(benchmark):
    """pykrak (Akins) solves one frequency at a time; skipped where it is not installed."""
    environment = pytest.importorskip(
        "pykrak.pykrak_env", reason="pykrak is not installed: no independent normal-mode code to compare with"
    )
    column = [[np.array(pair)] for pair in ([0.0, 45.0], [1505.0, 1505.0], [0.0, 0.0], [1.0, 1.0])]
    guide = environment.Env(*column, column[2], column[2], 1500.0, 0.0, 0.0, 0.0, 0.0, 1596.0, 0.0, 1.6,
                            0.12, 0.0, "dbplam", np.zeros(2))  # fmt: skip

    def reference(frequencies):
        return [guide.get_modes(f, [2000], 0.0, 1400.0, 1596.0)[0] for f in frequencies]

    reference(ARRAY.frequency[:1])
    modes = benchmark(solve_modes, SEA, ARRAY.frequency)
    some = ARRAY.frequency[::41]
    slow = 41 * seconds(reference, some)
    benchmark.extra_info["times_pykrak"] = slow / benchmark.stats["median"]
    for index, found in zip(range(0, 410, 41), reference(some), strict=True):
        deep = SEA.cutoff_frequency(np.arange(1, len(found) + 1)) * 1.1 < ARRAY.frequency[index]
        ours = modes.wavenumber[: len(found), index]
        assert np.max(np.abs(ours / found.real - 1)[deep]) <= 2e-5
    assert slow > benchmark.stats["median"]
