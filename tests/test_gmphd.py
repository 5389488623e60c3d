"""The GM-PHD filter against plain loops, its conservation laws, and the reference scenario over 50 seeds."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from labsim import bistatic as bs
from labsim import gmphd as gm
from labsim.metrics import ospa

MODEL = gm.PhdModel()
SCENE = bs.BistaticScenario()
EVERYTHING = 1e12


def random_mixture(seed, count, spread=2_000.0):
    rng = np.random.default_rng(seed)
    mean = rng.standard_normal((count, 4)) * [spread, 3.0, spread, 3.0]
    root = rng.standard_normal((count, 4, 4)) * np.array([100.0, 1.0, 100.0, 1.0])[:, None]
    covariance = root @ root.swapaxes(1, 2) + np.diag([1e3, 0.1, 1e3, 0.1])
    return gm.make_mixture(rng.uniform(0.01, 1.2, count), mean, covariance)


def random_measurements(seed, count, spread=2_000.0):
    rng = np.random.default_rng(seed)
    root = rng.standard_normal((count, 2, 2)) * 50
    covariance = root @ root.swapaxes(1, 2) + 400 * np.eye(2)
    value = rng.standard_normal((count, 2)) * spread
    return gm.Measurements(value, covariance, rng.uniform(1e-8, 1e-6, count))


native = bs.observer(SCENE)


def textbook_update(mixture, measurements, observe, detection):
    """The update as the textbook writes it: one pair at a time, no gate."""
    predicted, jacobian = observe(mixture.mean)
    weights, means, covariances = [], [], []
    for value, noise, clutter in zip(
        measurements.value, measurements.covariance, measurements.clutter, strict=True
    ):
        pairs = []
        for w, m, P, h, H in zip(
            mixture.weight, mixture.mean, mixture.covariance, predicted, jacobian, strict=True
        ):
            S = H @ P @ H.T + noise
            K = P @ H.T @ np.linalg.inv(S)
            e = value - h
            q = np.exp(-0.5 * e @ np.linalg.solve(S, e)) / np.sqrt(np.linalg.det(2 * np.pi * S))
            pairs.append(detection * w * q)
            means.append(m + K @ e)
            covariances.append((np.eye(4) - K @ H) @ P @ (np.eye(4) - K @ H).T + K @ noise @ K.T)
        weights += list(np.array(pairs) / (clutter + sum(pairs)))
    order = np.arange(len(weights)).reshape(len(measurements), -1).T.ravel()
    return np.array(weights)[order], np.array(means)[order], np.array(covariances)[order]


def test_prediction_is_the_motion_model_component_by_component():
    mixture = random_mixture(1, 5)
    moved = gm.predict(mixture, MODEL)
    F = np.array([[1, 20, 0, 0], [0, 1, 0, 0], [0, 0, 1, 20], [0, 0, 0, 1.0]])
    G = np.array([[200, 0], [20, 0], [0, 200], [0, 20.0]])
    for k in range(5):
        np.testing.assert_allclose(moved.mean[k], F @ mixture.mean[k])
        np.testing.assert_allclose(moved.covariance[k], F @ mixture.covariance[k] @ F.T + G @ G.T * 0.02**2)
    np.testing.assert_allclose(moved.weight, 0.99 * mixture.weight)
    assert np.linalg.matrix_rank(MODEL.process) == 2


@pytest.mark.parametrize("count", [1, 7])
def test_update_is_the_textbook_update_in_the_plane(count):
    mixture, measurements = random_mixture(2, 6), random_measurements(3, count)
    heard = gm.update(mixture, measurements, gm.observe_position, replace(MODEL, gate=EVERYTHING))
    weight, mean, covariance = textbook_update(mixture, measurements, gm.observe_position, 0.9)
    np.testing.assert_allclose(heard.weight[:6], 0.1 * mixture.weight)
    np.testing.assert_allclose(heard.weight[6:], weight, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(heard.mean[6:], mean, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(heard.covariance[6:], covariance, rtol=1e-7, atol=1e-4)


def test_update_is_the_textbook_update_in_bearing_delay_and_doppler():
    mixture = random_mixture(4, 5, spread=500.0)
    mixture = replace(mixture, mean=mixture.mean + [1_000, 0, 5_000, 0])
    detections = bs.simulate_detections(np.random.default_rng(5), SCENE).scan(30)
    measurements = gm.Measurements(*bs.native_measurements(SCENE, detections), angle_first=True)
    heard = gm.update(mixture, measurements, native, replace(MODEL, gate=EVERYTHING))
    weight, mean, covariance = textbook_update(mixture, measurements, native, 0.9)
    np.testing.assert_allclose(heard.weight[5:], weight, rtol=1e-7, atol=1e-15)
    np.testing.assert_allclose(heard.mean[5:], mean, rtol=1e-7, atol=1e-5)
    np.testing.assert_allclose(heard.covariance[5:], covariance, rtol=1e-5, atol=1e-3)


def test_the_gate_drops_only_pairs_of_no_weight():
    mixture, measurements = random_mixture(6, 20), random_measurements(7, 20)
    gated = gm.update(mixture, measurements, gm.observe_position, MODEL)
    full = gm.update(mixture, measurements, gm.observe_position, replace(MODEL, gate=EVERYTHING))
    assert len(gated) < len(full)
    assert gated.weight.sum() == pytest.approx(full.weight.sum(), abs=0.02)


def test_a_bearing_gate_reaches_across_the_cut_of_the_angle():
    mixture = gm.make_mixture([1.0], [[-5_000.0, 0.0, -30.0, 0.0]], np.diag([1e4, 1.0, 1e4, 1.0])[None])
    value, _ = native(np.array([[-5_000.0, 0.0, 30.0, 0.0]]))
    noise = np.diag([1e-4, 1e-4])[None]
    measurements = gm.Measurements(value[:, :2], noise, np.array([1e-9]), angle_first=True)
    heard = gm.update(mixture, measurements, lambda m: tuple(a[:, :2] for a in native(m)), MODEL)
    assert len(heard) == 2 and abs(heard.mean[1, 2]) < 30


@given(st.integers(0, 10_000), st.integers(1, 8))
def test_without_clutter_every_gated_measurement_is_one_target(seed, count):
    mixture, measurements = random_mixture(seed, 5, 200.0), random_measurements(seed + 1, count, 200.0)
    measurements = replace(measurements, clutter=np.zeros(count))
    heard = gm.update(mixture, measurements, gm.observe_position, replace(MODEL, gate=EVERYTHING))
    assert heard.weight[5:].sum() == pytest.approx(count)
    assert heard.weight[:5].sum() == pytest.approx(0.1 * mixture.weight.sum())


@given(st.integers(0, 10_000))
def test_the_order_of_the_measurements_does_not_matter(seed):
    mixture, measurements = random_mixture(seed, 6, 500.0), random_measurements(seed + 1, 6, 500.0)
    order = np.random.default_rng(seed).permutation(6)
    shuffled = gm.Measurements(
        measurements.value[order], measurements.covariance[order], measurements.clutter[order]
    )
    one, other = (gm.step(mixture, m, gm.observe_position, MODEL) for m in (measurements, shuffled))
    np.testing.assert_allclose(np.sort(one.weight), np.sort(other.weight), rtol=1e-9)


@settings(max_examples=30)
@given(st.integers(0, 10_000), st.floats(-3, 3))
def test_turning_the_world_turns_the_mixture(seed, angle):
    turn = np.kron([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]], np.eye(2))
    plane = turn[0::2, 0::2]
    mixture, measurements = random_mixture(seed, 6, 500.0), random_measurements(seed + 1, 6, 500.0)
    model = replace(MODEL, birth_weight=0.0)
    turned_mixture = replace(
        mixture, mean=mixture.mean @ turn.T, covariance=_symmetric(turn @ mixture.covariance @ turn.T)
    )
    turned_measurements = replace(
        measurements,
        value=measurements.value @ plane.T,
        covariance=_symmetric(plane @ measurements.covariance @ plane.T),
    )
    one = gm.step(mixture, measurements, gm.observe_position, model)
    other = gm.step(turned_mixture, turned_measurements, gm.observe_position, model)
    np.testing.assert_allclose(np.sort(one.weight), np.sort(other.weight), rtol=1e-6)


def _symmetric(covariance):
    return (covariance + covariance.swapaxes(1, 2)) / 2


def greedy_merge(mixture, within):
    """Which components the textbook merges, by lists and loops."""
    left, clusters = set(range(len(mixture))), []
    while left:
        head = max(left, key=lambda i: mixture.weight[i])
        near = []
        for i in left:
            offset = mixture.mean[i] - mixture.mean[head]
            if offset @ np.linalg.solve(mixture.covariance[i], offset) <= within:
                near.append(i)
        clusters.append(sorted(near))
        left -= set(near)
    return clusters


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.integers(2, 25))
def test_merging_forms_the_textbook_clusters_and_keeps_the_moments(seed, count):
    mixture = random_mixture(seed, count, 150.0)
    merged = gm.merge(mixture, 4.0)
    clusters = greedy_merge(mixture, 4.0)
    assert sorted(mixture.label[c][np.argmax(mixture.weight[c])] for c in clusters) == sorted(merged.label)
    assert merged.weight.sum() == pytest.approx(mixture.weight.sum())
    np.testing.assert_allclose(merged.weight @ merged.mean, mixture.weight @ mixture.mean, atol=1e-6)

    def second_moment(m):
        return np.einsum("n,nij->ij", m.weight, m.covariance + m.mean[:, :, None] * m.mean[:, None, :])

    np.testing.assert_allclose(second_moment(merged), second_moment(mixture), rtol=1e-9)


def test_prune_cap_and_extract():
    unit = np.tile(np.eye(4), (4, 1, 1))
    mixture = gm.make_mixture([1e-6, 2.3, 0.7, 0.4], np.arange(16.0).reshape(4, 4), unit)
    np.testing.assert_array_equal(gm.prune(mixture, 1e-5).label, [1, 2, 3])
    np.testing.assert_array_equal(gm.cap(mixture, 2).label, [1, 2])
    states, labels = gm.extract(mixture)
    np.testing.assert_array_equal(labels, [1, 1, 2])
    np.testing.assert_array_equal(states, mixture.mean[[1, 1, 2]])


def steady_scans(heard):
    """Scans of one target at rest at a birth site, without clutter; `heard` says which scans detect it."""
    value, noise = np.array([[0.0, 8_000.0]]), np.diag([900.0, 900.0])[None]
    return [gm.Measurements(value[:n], noise[:n], np.full(n, 1e-8)) for n in map(int, heard)]


def test_one_miss_makes_the_plain_filter_forget_and_coasting_remembers_two():
    heard = [1, 1, 1, 1, 0, 1, 0, 0, 0, 0]
    plain = gm.run_filter(steady_scans(heard), gm.observe_position, MODEL, coasting=False)
    coasted = gm.run_filter(steady_scans(heard), gm.observe_position, MODEL)
    assert [len(r) for r in plain.reported] == heard
    assert [len(r) for r in coasted.reported] == [1, 1, 1, 1, 1, 1, 1, 1, 0, 0]
    assert np.all(plain.weight_sum == coasted.weight_sum)
    expected = 0.99 * 0.1 * plain.weight_sum[3] + len(MODEL.birth_sites) * 0.03 * 0.1
    assert plain.weight_sum[4] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("misses", [0, 1, 2])
def test_coasting_lasts_as_many_misses_as_the_model_says(misses):
    model = replace(MODEL, coast_misses=misses)
    run = gm.run_filter(steady_scans([1] * 4 + [0] * 5), gm.observe_position, model)
    assert [len(r) for r in run.reported] == [1] * (4 + misses) + [0] * (5 - misses)


def test_a_target_seen_once_is_not_remembered():
    run = gm.run_filter(steady_scans([1, 0, 0]), gm.observe_position, MODEL)
    assert [len(r) for r in run.reported] == [1, 0, 0]


def test_labels_survive_predicting_updating_and_merging():
    mixture = gm.empty_mixture()
    labels = []
    for number, measurements in enumerate(steady_scans([1] * 5)):
        mixture = gm.step(mixture, measurements, gm.observe_position, MODEL, 4 * number)
        labels.append(gm.extract(mixture)[1].tolist())
    assert labels == [labels[0]] * 5 and len(labels[0]) == 1


def test_the_tracker_confirms_holds_through_misses_and_drops():
    run = gm.run_tracker(steady_scans([1, 1, 1, 0, 0, 1, 0, 0, 0, 0]), gm.Tracker())
    assert [len(r) for r in run.reported] == [0, 0, 1, 1, 1, 1, 1, 1, 0, 0]


def test_the_tracker_gives_each_measurement_to_one_track():
    value = np.array([[0.0, 5_000.0], [60.0, 5_000.0]])
    noise = np.tile(np.diag([900.0, 900.0]), (2, 1, 1))
    scans = [gm.Measurements(value, noise, np.full(2, 1e-8))] * 6
    run = gm.run_tracker(scans, gm.Tracker())
    assert len(run.reported[-1]) == 2
    assert run.reported[-1][:, 0].max() - run.reported[-1][:, 0].min() == pytest.approx(60, abs=1)


# ---- the reference scenario: 20 clutter detections per scan, P_D 0.9, seeds 1000 to 1049 ----

METHODS = ("converted", "plain", "doppler", "tracker")


@pytest.fixture(scope="module")
def reference():
    """Per method: (50, 4) of OSPA, its location and cardinality parts, and weight-sum bias, scan averages."""
    truth = bs.true_states(SCENE)
    places = [states[np.isfinite(states[:, 0])][:, 0::2] for states in truth]
    number = np.array([len(place) for place in places])

    def score(run):
        parts = [ospa(r[:, 0::2], place, 500.0) for r, place in zip(run.reported, places, strict=True)]
        return [*np.mean(parts, axis=0), np.mean(run.weight_sum - number)]

    scores = {method: [] for method in METHODS}
    for seed in range(1000, 1050):
        detections = bs.simulate_detections(np.random.default_rng(seed), SCENE)
        scans = [detections.scan(k) for k in range(SCENE.scans)]
        plane = [gm.Measurements(*bs.converted_measurements(SCENE, scan)) for scan in scans]
        raw = [gm.Measurements(*bs.native_measurements(SCENE, scan), angle_first=True) for scan in scans]
        scores["converted"].append(score(gm.run_filter(plane, gm.observe_position, MODEL)))
        scores["plain"].append(score(gm.run_filter(plane, gm.observe_position, MODEL, coasting=False)))
        scores["doppler"].append(score(gm.run_filter(raw, native, MODEL)))
        scores["tracker"].append(score(gm.run_tracker(plane, gm.Tracker(MODEL))))
    return {method: np.array(values) for method, values in scores.items()}


def test_the_filters_keep_their_distances(reference):
    # regression values: what this code gave over these 50 seeds, and four standard errors of it
    average = {method: reference[method][:, 0].mean() for method in METHODS}
    assert average["converted"] == pytest.approx(69.6, abs=4 * 1.0)
    assert average["doppler"] == pytest.approx(61.7, abs=4 * 0.9)
    assert average["plain"] == pytest.approx(126.1, abs=4 * 2.1)


def test_both_filters_beat_the_nearest_neighbour_tracker_on_the_same_detections(reference):
    # paired differences over 50 seeds: 10.1 +- 1.6, 18.1 +- 1.5 and -46.4 +- 2.4 m
    gain = {method: np.mean(reference["tracker"][:, 0] - reference[method][:, 0]) for method in METHODS}
    assert gain["converted"] >= 8
    assert gain["doppler"] >= 15
    assert gain["plain"] < -20


def test_the_weight_sum_is_nearly_unbiased(reference):
    # over 50 seeds: 0.10, 0.10 and 0.08 targets, standard errors 0.012
    for method in ("converted", "plain", "doppler"):
        assert abs(reference[method][:, 3].mean()) <= 0.15


def test_coasting_mends_cardinality_and_leaves_location(reference):
    # paired differences over 50 seeds: 1.2 +- 0.4 and -62.6 +- 2.4 m
    location, cardinality = (reference["converted"] - reference["plain"])[:, 1:3].mean(axis=0)
    assert cardinality < -50 and abs(location) < 5


# ---- bad input and extremes ----


def test_no_components_and_no_measurements_give_empty_answers():
    nobody, nothing = gm.empty_mixture(), random_measurements(1, 0)
    assert len(gm.update(nobody, random_measurements(1, 3), gm.observe_position, MODEL)) == 0
    assert len(gm.merge(nobody, 4.0)) == len(gm.prune(nobody, 0.1)) == len(gm.cap(nobody, 3)) == 0
    states, labels = gm.extract(nobody)
    assert states.shape == (0, 4) and labels.shape == (0,)
    barren = replace(MODEL, birth_sites=())
    run = gm.run_filter([nothing] * 3, gm.observe_position, barren)
    assert [len(r) for r in run.reported] == [0, 0, 0] and np.all(run.weight_sum == 0)
    assert gm.run_filter([], gm.observe_position, MODEL).reported == []
    assert [len(r) for r in gm.run_tracker([nothing] * 2, gm.Tracker()).reported] == [0, 0]
    quiet = gm.update(random_mixture(1, 3), nothing, gm.observe_position, MODEL)
    np.testing.assert_allclose(quiet.weight, 0.1 * random_mixture(1, 3).weight)


@pytest.mark.parametrize("detection", [0.0, 1.0])
def test_certain_and_impossible_detection_work(detection):
    model = replace(MODEL, detection=detection)
    mixture = gm.step(random_mixture(1, 5), random_measurements(2, 5), gm.observe_position, model)
    assert np.all(np.isfinite(mixture.weight)) and np.all(np.isfinite(mixture.mean))


def test_hundreds_of_measurements_and_components_pass():
    mixture = gm.step(random_mixture(3, 300), random_measurements(4, 600), gm.observe_position, MODEL)
    assert 0 < len(mixture) <= MODEL.most
    assert np.all(np.linalg.eigvalsh(mixture.covariance) > 0)


def test_covariances_stay_positive_over_the_whole_scene():
    detections = bs.simulate_detections(np.random.default_rng(1000), SCENE)
    mixture = gm.empty_mixture()
    for number in range(SCENE.scans):
        measurements = gm.Measurements(*bs.converted_measurements(SCENE, detections.scan(number)))
        mixture = gm.step(mixture, measurements, gm.observe_position, MODEL, 4 * number)
        assert np.all(np.linalg.eigvalsh(mixture.covariance) > 0)


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"survival": 1.01}, "survival must lie between 0 and 1"),
        ({"detection": -0.1}, "detection must lie between 0 and 1"),
        ({"gate": 0.0}, "gate must be above 0"),
        ({"birth_weight": -1.0}, "birth_weight must not be negative"),
        ({"most": 2.5}, "most must be a whole number from 1 up"),
        ({"coast_misses": 0.5}, "coast_misses must be a whole number"),
        ({"survival": (0.9, 0.99)}, "survival must be one number"),
        ({"birth_sites": ((np.nan, 0.0),)}, "birth_sites must be finite"),
    ],
)
def test_models_that_cannot_be_are_refused_in_words(changes, words):
    with pytest.raises(ValueError, match=words):
        replace(MODEL, **changes)


def test_covariances_that_are_none_are_refused_in_words():
    value, clutter = np.zeros((1, 2)), np.ones(1)
    with pytest.raises(ValueError, match="covariance must be positive definite"):
        gm.Measurements(value, np.diag([1.0, -1.0])[None], clutter)
    with pytest.raises(ValueError, match="covariance must be symmetric"):
        gm.Measurements(value, np.array([[[1.0, 0.5], [0.0, 1.0]]]), clutter)
    with pytest.raises(ValueError, match="covariance must have shape"):
        gm.Measurements(value, np.eye(2), clutter)
    with pytest.raises(ValueError, match="covariance must be positive definite"):
        gm.make_mixture([1.0], np.zeros((1, 4)), np.zeros((1, 4, 4)))
    with pytest.raises(ValueError, match="weight must not be negative"):
        gm.make_mixture([-1.0], np.zeros((1, 4)), np.eye(4)[None])
    with pytest.raises(ValueError, match="clutter must not be negative"):
        gm.Measurements(value, np.eye(2)[None], [-1.0])
    with pytest.raises(ValueError, match="coordinates of value"):
        gm.Measurements(np.zeros((1, 1)), np.ones((1, 1, 1)), clutter)
    with pytest.raises(ValueError, match="confirm_hits must be a whole number from 1 up"):
        gm.Tracker(confirm_hits=0)
    with pytest.raises(ValueError, match="most must be a whole number"):
        gm.cap(gm.empty_mixture(), 2.5)
