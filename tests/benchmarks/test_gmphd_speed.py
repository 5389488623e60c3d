"""What the GM-PHD filter costs against components and measurements, and per scan of the reference scene.

Only ratios within one run are asserted; times are reported.
"""

from dataclasses import replace
from time import process_time

import numpy as np
import pytest
from test_gmphd import textbook_update

from labsim import bistatic as bs
from labsim import gmphd as gm

WIDE = gm.PhdModel(most=10_000)
SCENE = bs.BistaticScenario()


def scattered(components, measurements, seed=1):
    """A mixture and a scan spread over the reference region, most of them far apart."""
    rng = np.random.default_rng(seed)
    mean = rng.uniform([-8e3, -3, 300, -3], [8e3, 3, 9e3, 3], (components, 4))
    covariance = np.tile(np.diag([3e3, 0.3, 3e3, 0.3]), (components, 1, 1))
    value = rng.uniform([-8e3, 300], [8e3, 9e3], (measurements, 2))
    noise = np.tile(2_500 * np.eye(2), (measurements, 1, 1))
    mixture = gm.make_mixture(rng.uniform(1e-3, 1, components), mean, covariance)
    return mixture, gm.Measurements(value, noise, np.full(measurements, 1e-7))


def cpu_time(work, repeats=7):
    """Least CPU time of one call, s: what the load of the machine disturbs least."""
    spent = []
    for _ in range(repeats):
        start = process_time()
        work()
        spent.append(process_time() - start)
    return min(spent)


@pytest.mark.parametrize("components", [25, 100, 200, 400, 800])
def test_a_scan_against_the_number_of_components(benchmark, components):
    benchmark(gm.step, *scattered(components, 20), gm.observe_position, WIDE)


@pytest.mark.parametrize("measurements", [5, 20, 80, 320])
def test_a_scan_against_the_number_of_measurements(benchmark, measurements):
    benchmark(gm.step, *scattered(100, measurements), gm.observe_position, WIDE)


@pytest.mark.parametrize("components", [25, 200, 800])
def test_merging_against_the_number_of_components(benchmark, components):
    benchmark(gm.merge, scattered(components, 1)[0], 4.0)


def test_growth_is_at_most_quadratic_in_components_and_linear_in_measurements():
    def scan(components, measurements):
        case = scattered(components, measurements)
        return cpu_time(lambda: gm.step(*case, gm.observe_position, WIDE))

    assert scan(800, 20) < 2 * (800 / 100) ** 2 * scan(100, 20)
    assert scan(100, 320) < 2 * (320 / 20) * scan(100, 20)


def test_arrays_beat_a_loop_over_pairs_by_far():
    mixture, measurements = scattered(50, 20)

    def loops():
        return textbook_update(mixture, measurements, gm.observe_position, WIDE.detection)

    fast = cpu_time(lambda: gm.update(mixture, measurements, gm.observe_position, WIDE))
    slow = cpu_time(loops, repeats=3)
    ours = gm.update(mixture, measurements, gm.observe_position, replace(WIDE, gate=1e12)).weight[50:]
    np.testing.assert_allclose(ours, loops()[0], atol=1e-12)
    print(f"loop over pairs / arrays: {slow / fast:.0f}")
    assert slow > 20 * fast


@pytest.mark.parametrize("kind", ["converted", "Doppler"])
def test_a_whole_run_of_the_reference_scene(benchmark, kind):
    detections = bs.simulate_detections(np.random.default_rng(1000), SCENE)
    scans = [detections.scan(k) for k in range(SCENE.scans)]
    if kind == "converted":
        observe = gm.observe_position
        scans = [gm.Measurements(*bs.converted_measurements(SCENE, s)) for s in scans]
    else:
        observe = bs.observer(SCENE)
        scans = [gm.Measurements(*bs.native_measurements(SCENE, s), True) for s in scans]
    model = gm.PhdModel()
    spent = cpu_time(lambda: gm.run_filter(scans, observe, model), repeats=5) / len(scans)
    benchmark.extra_info["ms of CPU a scan"] = round(1e3 * spent, 2)
    assert len(benchmark(gm.run_filter, scans, observe, model).reported) == SCENE.scans
