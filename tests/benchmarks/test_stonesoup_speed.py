"""Our GM-PHD filter beside Stone Soup's, on the same detections and with the same model."""

import datetime
from time import process_time

import numpy as np
import pytest

from labsim import bistatic as bs
from labsim import gmphd as gm
from labsim.metrics import ospa

WHY = "Stone Soup is not installed: python -m pip install '.[peers]' to compare with it"
pytest.importorskip("stonesoup", reason=WHY)

from stonesoup.hypothesiser.distance import DistanceHypothesiser  # noqa: E402
from stonesoup.hypothesiser.gaussianmixture import GaussianMixtureHypothesiser  # noqa: E402
from stonesoup.measures import Mahalanobis  # noqa: E402
from stonesoup.mixturereducer.gaussianmixture import GaussianMixtureReducer  # noqa: E402
from stonesoup.models.measurement.linear import LinearGaussian  # noqa: E402
from stonesoup.models.transition.linear import LinearGaussianTimeInvariantTransitionModel  # noqa: E402
from stonesoup.predictor.kalman import KalmanPredictor  # noqa: E402
from stonesoup.types.detection import Detection  # noqa: E402
from stonesoup.types.state import TaggedWeightedGaussianState  # noqa: E402
from stonesoup.updater.kalman import KalmanUpdater  # noqa: E402
from stonesoup.updater.pointprocess import PHDUpdater  # noqa: E402

MODEL = gm.PhdModel()
SCENE = bs.BistaticScenario()
START = datetime.datetime(2023, 2, 1)
AT_ONCE = datetime.timedelta(0)
CLUTTER = SCENE.clutter_rate / bs.region_area(SCENE)


class Motion(LinearGaussianTimeInvariantTransitionModel):
    """The library's model ignores the time interval; births of this scan must not be moved."""

    def matrix(self, time_interval=None, **kwargs):
        return np.eye(4) if time_interval == AT_ONCE else super().matrix(**kwargs)

    def covar(self, time_interval=None, **kwargs):
        return np.zeros((4, 4)) if time_interval == AT_ONCE else super().covar(**kwargs)


def peer(survival):
    """Stone Soup's hypothesiser and updater with our model."""
    motion = Motion(transition_matrix=MODEL.transition, covariance_matrix=MODEL.process)
    updater = KalmanUpdater(measurement_model=None)
    distance = DistanceHypothesiser(
        KalmanPredictor(motion), updater, Mahalanobis(), missed_distance=np.sqrt(MODEL.gate)
    )
    phd = PHDUpdater(
        updater, clutter_spatial_density=CLUTTER, prob_detection=MODEL.detection, prob_survival=survival
    )
    return GaussianMixtureHypothesiser(distance, order_by_detection=True), phd


def components(mixture, when, tag=None):
    return [
        TaggedWeightedGaussianState(m, P, weight=w, tag=tag or f"component {k}", timestamp=when)
        for k, (w, m, P) in enumerate(zip(mixture.weight, mixture.mean, mixture.covariance, strict=True))
    ]


def detections_of(measurements, when):
    return [
        Detection(z, timestamp=when, measurement_model=LinearGaussian(4, (0, 2), R))
        for z, R in zip(measurements.value, measurements.covariance, strict=True)
    ]


def plane_scans(seed):
    """One run of the scene in x and y, with the constant clutter density that Stone Soup takes."""
    detections = bs.simulate_detections(np.random.default_rng(seed), SCENE)
    scans = (bs.converted_measurements(SCENE, detections.scan(k)) for k in range(SCENE.scans))
    return [gm.Measurements(value, R, np.full(len(value), CLUTTER)) for value, R, _ in scans]


def test_one_update_equals_stone_soups():
    hypothesiser, phd = peer(survival=1.0)
    mixture, compared = gm.empty_mixture(), 0
    for number, measurements in enumerate(plane_scans(1000)[:30]):
        prior = gm.add_births(gm.predict(mixture, MODEL), MODEL, 4 * number)
        when = START + datetime.timedelta(seconds=20 * number)
        heard = detections_of(measurements, when)
        theirs = phd.update(hypothesiser.hypothesise(components(prior, when), heard, when))
        ours = gm.update(prior, measurements, gm.observe_position, MODEL)
        order = np.lexsort(gm.gated_pairs(prior, measurements, gm.observe_position, MODEL.gate)[:2])
        ours = gm.join(ours.take(len(prior) + order), ours.take(np.arange(len(prior))))
        assert len(theirs) == len(ours)
        np.testing.assert_allclose([float(c.weight) for c in theirs], ours.weight, rtol=0, atol=1e-12)
        np.testing.assert_allclose([np.ravel(c.mean) for c in theirs], ours.mean, rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose([c.covar for c in theirs], ours.covariance, rtol=1e-6, atol=1e-6)
        compared += len(ours)
        mixture = gm.step(mixture, measurements, gm.observe_position, MODEL, 4 * number)
    assert compared > 300


def run_peer(scans):
    """Stone Soup over all scans: reported positions of every scan and the CPU time, s."""
    hypothesiser, phd = peer(MODEL.survival)
    reducer = GaussianMixtureReducer(
        prune_threshold=MODEL.prune_below,
        merge_threshold=MODEL.merge_within,
        max_number_components=MODEL.most,
    )
    kept, reported, start = [], [], process_time()
    for number, measurements in enumerate(scans):
        when = START + datetime.timedelta(seconds=20 * number)
        kept = kept + components(MODEL.births, when, "birth")
        hypotheses = hypothesiser.hypothesise(kept, detections_of(measurements, when), when)
        kept = list(reducer.reduce(list(phd.update(hypotheses))))
        heavy = [c for c in kept if c.weight > MODEL.report_above]
        reported.append(np.reshape([np.ravel(c.mean)[0::2] for c in heavy], (-1, 2)).astype(float))
    return reported, process_time() - start


def test_whole_runs_agree_in_ospa_and_ours_is_a_hundred_times_faster():
    # the same three runs for both: a paired difference, and the least CPU times, least disturbed by load
    truth = [states[np.isfinite(states[:, 0])][:, 0::2] for states in bs.true_states(SCENE)]
    difference, their_times, our_times = [], [], []
    for seed in (1000, 1001, 1002):
        scans = plane_scans(seed)
        theirs, their_time = run_peer(scans)
        their_times.append(their_time)
        for _ in range(5):
            start = process_time()
            ours = gm.run_filter(scans, gm.observe_position, MODEL, coasting=False)
            our_times.append(process_time() - start)
        one = np.mean([ospa(r[:, 0::2], t, 500.0)[0] for r, t in zip(ours.reported, truth, strict=True)])
        other = np.mean([ospa(r, t, 500.0)[0] for r, t in zip(theirs, truth, strict=True)])
        difference.append(one - other)
    ratio = min(their_times) / min(our_times)
    print(f"OSPA ours minus theirs {np.mean(difference):.1f} m, CPU ratio {ratio:.0f}")
    assert abs(np.mean(difference)) <= 5
    assert ratio >= 100
