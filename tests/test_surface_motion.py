"""The chain direction -> position -> velocity against theory, invariance, bounds and the paper's scenario."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from labsim import surface_motion as sm
from labsim.metrics import angle_difference, rmse
from labsim.motion import waypoint_track
from labsim.vector_sensor import (
    PassingVessel,
    cramer_rao_bound,
    direction_of_arrival,
    expected_error,
    geometry,
    sample_intensity,
    snr,
    window_centres,
)

PAPER = PassingVessel()
TIME = window_centres(PAPER)
HEARD = geometry(PAPER, TIME)
EMITTED = TIME - HEARD.slant_range / PAPER.sound_speed
VELOCITY = PAPER.motion.velocity(0.0)
ERROR = expected_error(PAPER, TIME)
DEPTH, WINDOW, SOUND_SPEED = PAPER.sensor_depth, PAPER.window, PAPER.sound_speed
AT_20_S = 39
TRIALS = 1000


@pytest.fixture(scope="module")
def directions():
    return direction_of_arrival(sample_intensity(PAPER, np.random.default_rng(12), TRIALS))


@pytest.fixture(scope="module")
def points(directions):
    return sm.position(*directions, DEPTH)


@pytest.fixture(scope="module")
def emitted(points):
    return sm.emission_time(points, TIME, DEPTH, SOUND_SPEED)


def vector_rmse(estimate, truth=VELOCITY):
    """RMSE of the length of the error vector over trials, and its standard error, for each window."""
    square = np.sum((estimate - truth) ** 2, axis=-1)
    value = np.sqrt(square.mean(axis=0))
    return value, square.std(axis=0) / (2 * value * np.sqrt(len(square)))


def assert_within(measured, error, expected, count=3):
    assert abs(measured - expected) < count * error, f"{measured:.4g} +- {error:.2g}, expected {expected:.4g}"


# The paper's scenario: velocity error at 20 s, 14 dB; 1000 trials, seed 12; three standard errors and the
# half unit of the last printed digit.


@pytest.mark.parametrize(
    ("method", "expected", "rounding"),
    [("raw", 8.2, 0.05), ("literal", 4.3, 0.05), ("growing", 0.21, 0.005), ("weighted", 0.137, 0.0005)],
)
def test_velocity_error_at_20_s(points, emitted, method, expected, rounding):
    velocity = {
        "raw": lambda: sm.difference_velocity(points, WINDOW),
        "literal": lambda: sm.line_fit_velocity(points, WINDOW),
        "growing": lambda: sm.motion_fit(points, emitted).velocity,
        "weighted": lambda: sm.weighted_motion_fit(points, emitted, DEPTH, ERROR).velocity,
    }[method]()
    value, error = vector_rmse(velocity[:, : AT_20_S + 1])
    assert abs(value[AT_20_S] - expected) < 3 * error[AT_20_S] + rounding


def test_maximum_likelihood_meets_its_bound_at_20_s(directions):
    first = slice(0, AT_20_S + 1)
    azimuth, angle = directions[0][:, first], directions[1][:, first]
    estimate = sm.maximum_likelihood_motion(azimuth, angle, TIME[first], DEPTH, SOUND_SPEED, ERROR[first])
    value, error = vector_rmse(estimate.velocity[:, 0])
    bound = sm.motion_bound(HEARD.position, EMITTED, DEPTH, ERROR)[1][AT_20_S]
    assert bound == pytest.approx(0.138, abs=0.0005)
    assert_within(value, error, bound)


def test_the_bound_of_all_four_channels_lies_below_that_of_intensity_angles():
    least = cramer_rao_bound(snr(PAPER, TIME), PAPER.time_bandwidth)
    full = sm.motion_bound(HEARD.position, EMITTED, DEPTH, least)
    angles = sm.motion_bound(HEARD.position, EMITTED, DEPTH, ERROR)
    assert full[1][AT_20_S] == pytest.approx(0.136, abs=0.0005)
    assert full[1][-1] == pytest.approx(0.050, abs=0.0005)
    for better, worse in zip(full, angles, strict=True):
        assert np.all(better[1:] < worse[1:])


def test_maximum_likelihood_is_the_least_squares_of_the_sphere(directions):
    # Independent: scipy minimises the miss across each line of sight, retarded, from another start. Far from
    # the sensor the two define the miss of a large error differently, by its third power; hence 0.005 m/s.
    first = slice(0, AT_20_S + 1)
    azimuth, angle = directions[0][0, first], directions[1][0, first]

    def misses(parameters):
        vessel = replace(
            PAPER, start=tuple(parameters[:2]), speed=np.hypot(*parameters[2:]),
            heading=np.arctan2(parameters[3], parameters[2]),
        )  # fmt: skip
        model = geometry(vessel, TIME[first])
        across = np.sin(angle) * np.sin(azimuth - model.azimuth)
        return np.concatenate([across, angle - model.angle_from_vertical]) / np.tile(ERROR[first], 2)

    expected = least_squares(misses, [-200.0, 50.0, 5.0, 5.0], x_scale=[100, 100, 10, 10]).x
    estimate = sm.maximum_likelihood_motion(azimuth, angle, TIME[first], DEPTH, SOUND_SPEED, ERROR[first])
    np.testing.assert_allclose(estimate.velocity[0], expected[2:], atol=0.005)


def test_maximum_likelihood_has_converged_even_at_0_db(monkeypatch):
    faint = replace(PAPER, snr_db=0.0)
    azimuth, angle = direction_of_arrival(sample_intensity(faint, np.random.default_rng(1), 100))
    arguments = (azimuth, angle, TIME, DEPTH, SOUND_SPEED, 10 * ERROR)
    usual = sm.maximum_likelihood_motion(*arguments)
    monkeypatch.setattr(sm, "STEPS", 5 * sm.STEPS)
    np.testing.assert_allclose(sm.maximum_likelihood_motion(*arguments).velocity, usual.velocity, atol=1e-5)


def test_positions_of_the_weighted_fit_err_as_their_bound_says(points, emitted):
    fitted = sm.weighted_motion_fit(points, emitted, DEPTH, ERROR).position
    value, error = vector_rmse(fitted, HEARD.position)
    bound = sm.motion_bound(HEARD.position, EMITTED, DEPTH, ERROR)[0]
    for window in (AT_20_S, 79, 119):
        assert_within(value[window], error[window], bound[window])


def test_the_weighted_fit_reaches_the_bound_late_and_the_unweighted_one_gets_worse(points, emitted):
    bound = sm.motion_bound(HEARD.position, EMITTED, DEPTH, ERROR)[1]
    weighted, error = vector_rmse(sm.weighted_motion_fit(points, emitted, DEPTH, ERROR).velocity)
    for window in (AT_20_S, 79, 119):
        assert_within(weighted[window], error[window], bound[window])
    growing, _ = vector_rmse(sm.motion_fit(points, emitted).velocity)
    assert growing[79] < 0.1 < 0.2 < growing[119]


def test_weights_taken_at_the_noisy_points_bend_the_fit(points, emitted):
    naive = sm.motion_fit(points, emitted, sm.position_precision(points, DEPTH, ERROR)).velocity[:, -1]
    good = sm.weighted_motion_fit(points, emitted, DEPTH, ERROR).velocity[:, -1]
    standard_error = naive.std(axis=0) / np.sqrt(TRIALS)
    assert np.mean(naive[:, 0] - VELOCITY[0]) < -10 * standard_error[0]
    assert abs(np.mean(good[:, 0] - VELOCITY[0])) < 4 * standard_error[0]


@pytest.mark.parametrize("span", [20, 40])
def test_a_sliding_centred_fit_errs_as_the_covariance_of_its_positions_says(points, emitted, span):
    # Slopes of least squares weigh each position by its offset in time over the sum of squared offsets.
    value, error = vector_rmse(sm.motion_fit(points, emitted, span=span, centred=True).velocity)
    used = slice(AT_20_S - span // 2, AT_20_S + span // 2)
    offset = EMITTED[used] - EMITTED[used].mean()
    spread = np.linalg.inv(sm.position_precision(HEARD.position, DEPTH, ERROR))[used]
    weight = offset / np.sum(offset**2)
    expected = np.sqrt(np.sum(weight**2 * np.trace(spread, axis1=1, axis2=2)))
    assert_within(value[AT_20_S], error[AT_20_S], expected)


@pytest.mark.parametrize(("window", "beyond"), [(20, 0.0), (25, 0.0), (95, 0.08), (100, 0.12)])
def test_a_weighted_span_near_the_ends_errs_as_its_bound_says(points, emitted, window, beyond):
    # Centred spans of 20 s, the first and last whole ones among them. 1000 trials, seed 12; three standard
    # errors of about 2 %. Far out the tangent bends what it sees, by the square of the error of angle: the
    # share `beyond` the bound at 14 dB, a quarter of that at 20 dB.
    bound = sm.motion_bound(HEARD.position, EMITTED, DEPTH, ERROR, span=40, centred=True)[1][window]
    fitted = sm.weighted_motion_fit(points, emitted, DEPTH, ERROR, span=40, centred=True).velocity
    value, error = vector_rmse(fitted)
    assert abs(value[window] / bound - 1) < beyond + 3 * error[window] / bound


def test_a_weighted_span_near_the_ends_is_hardly_biased():
    # 20 dB, 1000 trials, seed 14: what the tangent leaves at 50 s is below a fifth of the RMSE.
    loud = replace(PAPER, snr_db=20.0)
    error = expected_error(loud, TIME)
    azimuth, angle = direction_of_arrival(sample_intensity(loud, np.random.default_rng(14), TRIALS))
    points = sm.position(azimuth, angle, DEPTH)
    emitted = sm.emission_time(points, TIME, DEPTH, SOUND_SPEED)
    miss = sm.weighted_motion_fit(points, emitted, DEPTH, error, span=40, centred=True).velocity - VELOCITY
    for window in (20, 100):
        assert np.linalg.norm(miss[:, window].mean(axis=0)) < 0.2 * vector_rmse(miss[:, window], 0.0)[0]


# Why the literal fit cannot do better: the step of x stays raw.


def test_the_literal_fit_keeps_the_raw_step_of_x(points):
    literal = sm.line_fit_velocity(points, WINDOW)
    np.testing.assert_array_equal(literal[..., 0], sm.difference_velocity(points, WINDOW)[..., 0])


def test_the_literal_fit_cleans_across_the_track_and_not_along_it(points):
    window = slice(AT_20_S - 2, AT_20_S + 3)
    split = [
        rmse(sm.along_and_across(method(points, WINDOW)[:, window] - VELOCITY, PAPER.heading), axis=(0, 1))
        for method in (sm.difference_velocity, sm.line_fit_velocity)
    ]
    (raw_along, raw_across), (along, across) = split
    assert across < 0.05 * raw_across
    assert 0.8 * raw_along < along < 1.2 * raw_along


def test_the_literal_fit_has_a_floor_even_without_noise():
    # The source itself is noise: its loudest moment wanders in each window by T/sqrt(12 B T) seconds, so
    # differences err by v/sqrt(6 B T). 400 trials, seed 31; at 100 dB nothing else is left. Five blocks
    # in a window carry 1 - 1/25 of the variance.
    loud = replace(PAPER, snr_db=100.0)
    azimuth, angle = direction_of_arrival(sample_intensity(loud, np.random.default_rng(31), 400))
    velocity = sm.line_fit_velocity(sm.position(azimuth, angle, DEPTH), WINDOW)
    value, error = vector_rmse(velocity[:, AT_20_S : AT_20_S + 1])
    floor = PAPER.speed / np.sqrt(6 * PAPER.time_bandwidth)
    assert floor == pytest.approx(0.283, abs=0.0005)
    assert_within(value, error, floor * np.sqrt(24 / 25))


def test_the_line_gives_the_heading_that_the_step_does_not():
    # Heading RMSE of the line at 40 s is 0.27 degrees (1000 trials, seed 13; 2.3 % standard error).
    azimuth, angle = direction_of_arrival(sample_intensity(PAPER, np.random.default_rng(13), TRIALS))
    slope, _ = sm.line_fit(sm.position(azimuth, angle, DEPTH))
    heading_error = np.degrees(rmse(np.arctan(slope[:, 79]) - PAPER.heading))
    assert heading_error == pytest.approx(0.27, rel=0.1)


# Error of position


def test_position_errors_follow_range_squared_and_range(points):
    error = points - HEARD.position
    radial, tangential = np.moveaxis(rmse(sm.along_and_across(error, HEARD.azimuth), axis=0), -1, 0)
    # The mean over 20 windows of 1000 trials: 1 % is three standard errors; the source's own noise adds a
    # little near closest approach, and the curvature of tan far out, so the windows are taken between.
    window = slice(60, 80)
    r = HEARD.slant_range[window]
    assert np.mean(radial[window] / (r**2 / DEPTH * ERROR[window])) == pytest.approx(1, abs=0.02)
    assert np.mean(tangential[window] / (r * ERROR[window])) == pytest.approx(1, abs=0.02)


def test_precision_is_the_inverse_of_the_radial_and_tangential_covariance():
    point, sigma = np.array([120.0, -50.0]), 0.01
    r2 = point @ point + DEPTH**2
    along = point / np.linalg.norm(point)
    across = np.array([-along[1], along[0]])
    covariance = sigma**2 * (r2**2 / DEPTH**2 * np.outer(along, along) + r2 * np.outer(across, across))
    precision = sm.position_precision(point, DEPTH, sigma)
    np.testing.assert_allclose(precision, np.linalg.inv(covariance), rtol=1e-9)


def test_the_bound_agrees_with_numerical_differentiation_of_the_directions():
    # Independent: derivatives of the true, retarded directions by the four parameters, by differences.
    # The module leaves out the parameters' effect on the emission time, at most v/c = 0.8 %.
    def angles(parameters):
        vessel = replace(
            PAPER, start=tuple(parameters[:2]), speed=np.hypot(*parameters[2:]),
            heading=np.arctan2(parameters[3], parameters[2]),
        )  # fmt: skip
        heard = geometry(vessel, TIME[: AT_20_S + 1])
        return np.stack([np.sin(heard.angle_from_vertical) * heard.azimuth, heard.angle_from_vertical])

    truth = np.array([*PAPER.start, *VELOCITY])
    sine = np.sin(HEARD.angle_from_vertical[: AT_20_S + 1])
    jacobian = []
    for step in 1e-3 * np.eye(4):
        high, low = angles(truth + step), angles(truth - step)
        scale = np.stack([sine, np.ones_like(sine)])
        high[0], low[0] = high[0] / np.sin(high[1]), low[0] / np.sin(low[1])
        jacobian.append((scale * (high - low) / 2e-3 / ERROR[: AT_20_S + 1]).ravel())
    covariance = np.linalg.inv(np.array(jacobian) @ np.array(jacobian).T)
    expected = np.sqrt(np.trace(covariance[2:, 2:]))
    bound = sm.motion_bound(HEARD.position, EMITTED, DEPTH, ERROR)[1][AT_20_S]
    assert bound == pytest.approx(expected, rel=PAPER.speed / SOUND_SPEED)


# Without noise every method is exact, and what is assumed wrongly shows


def exact_motion(points, time):
    return sm.motion_fit(points, time).velocity[..., 1:, :]


@pytest.mark.parametrize(
    "velocity",
    [
        lambda d: sm.difference_velocity(d, WINDOW)[1:],
        lambda d: sm.line_fit_velocity(d, WINDOW)[1:],
        lambda d: sm.orthogonal_fit_velocity(d, WINDOW)[1:],
        lambda d: exact_motion(d, TIME),
        lambda d: sm.weighted_motion_fit(d, TIME, DEPTH, ERROR).velocity[1:],
        lambda d: sm.motion_fit(d, TIME, span=10).velocity[9:],
        lambda d: sm.motion_fit(d, TIME, span=11, centred=True).velocity[5:-5],
        lambda d: sm.weighted_motion_fit(d, TIME, DEPTH, ERROR, span=11, centred=True).velocity[5:-5],
    ],
)
def test_every_method_is_exact_on_an_exact_straight_track(velocity):
    result = velocity(PAPER.motion.position(TIME))
    np.testing.assert_allclose(result, np.broadcast_to(VELOCITY, result.shape), rtol=1e-7, atol=1e-7)


def test_maximum_likelihood_is_exact_on_exact_retarded_directions():
    estimate = sm.maximum_likelihood_motion(
        HEARD.azimuth, HEARD.angle_from_vertical, TIME, DEPTH, SOUND_SPEED, ERROR
    )
    np.testing.assert_allclose(estimate.velocity[0], VELOCITY, rtol=1e-8)
    np.testing.assert_allclose(estimate.position, HEARD.position, atol=1e-5)


def test_neglecting_the_travel_time_biases_the_growing_fit():
    points = sm.position(HEARD.azimuth, HEARD.angle_from_vertical, DEPTH)
    biased = sm.motion_fit(points, TIME).velocity[AT_20_S]
    mended = sm.motion_fit(points, sm.emission_time(points, TIME, DEPTH, SOUND_SPEED)).velocity[AT_20_S]
    straight_through = np.polyfit(TIME[: AT_20_S + 1], points[: AT_20_S + 1], 1)[0]
    np.testing.assert_allclose(biased, straight_through, rtol=1e-9)
    assert np.linalg.norm(biased - VELOCITY) == pytest.approx(0.05, abs=0.005)
    np.testing.assert_allclose(mended, VELOCITY, rtol=1e-9)


@pytest.mark.parametrize("factor", [0.95, 1.05])
def test_a_wrong_depth_scales_speed_and_leaves_heading(factor):
    points = sm.position(HEARD.azimuth, HEARD.angle_from_vertical, factor * DEPTH)
    velocity = sm.motion_fit(points, EMITTED).velocity[-1]
    np.testing.assert_allclose(velocity, factor * VELOCITY, rtol=1e-9)


def test_a_wrong_sound_speed_hardly_matters():
    # It enters by the travel time alone: the delay, at most 0.35 s, is wrong by 5 %, and changes by much
    # less than that during the track.
    points = sm.position(HEARD.azimuth, HEARD.angle_from_vertical, DEPTH)
    times = sm.emission_time(points, TIME, DEPTH, 1.05 * SOUND_SPEED)
    velocity = sm.motion_fit(points, times).velocity[-1]
    assert np.linalg.norm(velocity - VELOCITY) < 0.005 * PAPER.speed


def test_a_vessel_that_turns_wants_a_short_memory():
    time = np.linspace(0.0, 60.0, 61)
    turn = np.clip((time - 20) / 20, 0, 1) * np.pi / 2
    steps = 12.0 * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    track = waypoint_track(time, np.array([-250.0, 50.0]) + np.cumsum(steps, axis=0))
    vessel = replace(PAPER, track=track, snr_db=30.0)
    heard = geometry(vessel, TIME)
    truth = track.velocity(TIME - heard.slant_range / SOUND_SPEED)
    heard = direction_of_arrival(sample_intensity(vessel, np.random.default_rng(3), 100))
    points = sm.position(*heard, DEPTH)
    emitted = sm.emission_time(points, TIME, DEPTH, SOUND_SPEED)
    late = slice(70, 100)
    growing = np.mean(vector_rmse(sm.motion_fit(points, emitted).velocity[:, late], truth[late])[0])
    sliding = sm.motion_fit(points, emitted, span=16, centred=True).velocity[:, late]
    assert np.mean(vector_rmse(sliding, truth[late])[0]) < growing / 4


# Invariance: rotate about the vertical, mirror, scale; the estimates follow

ANGLES = st.floats(-3.0, 3.0)
NOISY = np.random.default_rng(5).normal(scale=0.02, size=(2, TIME.size))


def estimators(azimuth, angle, time, depth, sound_speed):
    points = sm.position(azimuth, angle, depth)
    emitted = sm.emission_time(points, time, depth, sound_speed)
    window = time[1] - time[0]
    likely = sm.maximum_likelihood_motion(azimuth, angle, time, depth, sound_speed, ERROR)
    return {
        "raw": sm.difference_velocity(points, window)[1:],
        "orthogonal": sm.orthogonal_fit_velocity(points, window)[1:],
        "motion": sm.motion_fit(points, emitted).velocity[1:],
        "weighted": sm.weighted_motion_fit(points, emitted, depth, ERROR).velocity[1:],
        "likely": likely.velocity[:1],
    }


AZIMUTH = HEARD.azimuth + NOISY[0]
ANGLE = HEARD.angle_from_vertical + NOISY[1]
STILL_WORLD = estimators(AZIMUTH, ANGLE, TIME, DEPTH, SOUND_SPEED)


@settings(max_examples=15, deadline=None)
@given(turn=ANGLES)
def test_estimates_turn_with_the_world(turn):
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    turned = estimators(AZIMUTH + turn, ANGLE, TIME, DEPTH, SOUND_SPEED)
    for name, velocity in STILL_WORLD.items():
        np.testing.assert_allclose(turned[name], velocity @ rotation.T, atol=1e-6, err_msg=name)


def test_the_literal_line_does_not_turn_with_the_world():
    points = sm.position(AZIMUTH, ANGLE, DEPTH)
    quarter = sm.position(AZIMUTH + np.pi / 2, ANGLE, DEPTH)
    speed = np.linalg.norm(sm.line_fit_velocity(points, WINDOW)[AT_20_S])
    assert abs(np.linalg.norm(sm.line_fit_velocity(quarter, WINDOW)[AT_20_S]) - speed) > 0.1


def test_estimates_are_mirrored_with_the_world():
    mirrored = estimators(-AZIMUTH, ANGLE, TIME, DEPTH, SOUND_SPEED)
    for name, velocity in STILL_WORLD.items():
        np.testing.assert_allclose(mirrored[name], velocity * [1, -1], atol=1e-7, err_msg=name)
    slope, offset = sm.line_fit(sm.position(AZIMUTH, ANGLE, DEPTH))
    mirror_slope, mirror_offset = sm.line_fit(sm.position(-AZIMUTH, ANGLE, DEPTH))
    np.testing.assert_allclose(mirror_slope[1:], -slope[1:], rtol=1e-9)
    np.testing.assert_allclose(mirror_offset[1:], -offset[1:], rtol=1e-9)


@settings(max_examples=15, deadline=None)
@given(length=st.floats(0.1, 20.0), duration=st.floats(0.1, 20.0))
def test_estimates_scale_with_lengths_and_times(length, duration):
    speed = length / duration
    scaled = estimators(AZIMUTH, ANGLE, duration * TIME, length * DEPTH, speed * SOUND_SPEED)
    for name, velocity in STILL_WORLD.items():
        np.testing.assert_allclose(scaled[name] / speed, velocity, rtol=1e-6, atol=1e-6, err_msg=name)


@settings(max_examples=25, deadline=None)
@given(azimuth=ANGLES, angle=st.floats(0.0, 1.5), depth=st.floats(1.0, 5000.0))
def test_position_and_direction_undo_each_other(azimuth, angle, depth):
    x, y = sm.position(azimuth, angle, depth)
    assert np.arctan2(np.hypot(x, y), depth) == pytest.approx(angle, abs=1e-12)
    if angle > 1e-6:
        assert angle_difference(np.arctan2(y, x), azimuth) == pytest.approx(0, abs=1e-9)


# Shapes and gaps


def test_any_leading_batch_shape_gives_what_one_recording_gives(points, emitted):
    some, times = points[:6].reshape(2, 3, -1, 2), emitted[:6].reshape(2, 3, -1)
    batched = sm.weighted_motion_fit(some, times, DEPTH, ERROR, span=12)
    alone = sm.weighted_motion_fit(points[4], emitted[4], DEPTH, ERROR, span=12)
    np.testing.assert_allclose(batched.velocity[1, 1], alone.velocity, rtol=1e-6)
    np.testing.assert_allclose(sm.line_fit(some)[0][1, 1], sm.line_fit(points[4])[0], rtol=1e-9)


def test_unknown_windows_are_left_out_of_every_fit(directions):
    azimuth, angle = directions[0][0].copy(), directions[1][0].copy()
    gap = np.isin(np.arange(TIME.size), [0, 3, 30, 31, 119])
    azimuth[gap] = np.nan
    points = sm.position(azimuth, angle, DEPTH)
    assert np.isnan(points[gap]).all()
    kept = sm.motion_fit(points[~gap], TIME[~gap]).velocity
    np.testing.assert_allclose(sm.motion_fit(points, TIME).velocity[~gap], kept, rtol=1e-8)
    np.testing.assert_allclose(sm.line_fit(points)[0][~gap], sm.line_fit(points[~gap])[0], rtol=1e-8)
    arguments = (DEPTH, SOUND_SPEED)
    whole = sm.maximum_likelihood_motion(azimuth, angle, TIME, *arguments, ERROR)
    part = sm.maximum_likelihood_motion(azimuth[~gap], angle[~gap], TIME[~gap], *arguments, ERROR[~gap])
    np.testing.assert_allclose(whole.velocity[0], part.velocity[0], rtol=1e-8)
    assert np.isfinite(whole.position).all()


@pytest.mark.parametrize("centred", [False, True])
def test_unknown_windows_are_left_out_of_a_weighted_span(points, emitted, centred):
    # Weights taken at the true track do not need the first fit; with it, each record mends its own gaps.
    some, times = points[:3].copy(), emitted[:3].copy()
    some[1, [0, 3, 30, 31, 119]], times[1, [0, 3, 30, 31, 119]] = np.nan, np.nan
    some[2, 20:54], times[2, 20:54] = np.nan, np.nan
    fitted = sm.weighted_motion_fit(some, times, DEPTH, ERROR, span=20, centred=centred).velocity
    weights = sm.position_precision(HEARD.position, DEPTH, ERROR)
    ideal = sm.motion_fit(some, times, weights, span=20, centred=centred).velocity
    np.testing.assert_array_equal(np.isnan(fitted), np.isnan(ideal))
    assert np.isfinite(fitted[1]).any() and np.isnan(fitted[2, 42]).all()
    near = slice(20, 60)
    assert np.nanmax(np.abs(fitted - ideal)[:, near]) < 0.3 * np.nanmax(np.abs(ideal - VELOCITY)[:, near])
    alone = sm.weighted_motion_fit(some[1], times[1], DEPTH, ERROR, span=20, centred=centred).velocity
    np.testing.assert_allclose(fitted[1], alone, rtol=1e-6)


def test_a_span_without_a_single_fit_is_unknown():
    points = np.full((6, 2), np.nan)
    points[2] = 10.0
    assert np.isnan(sm.weighted_motion_fit(points, np.arange(6.0), DEPTH, 0.01, span=3).velocity).all()


def test_two_positions_are_needed():
    points = PAPER.motion.position(TIME)
    points[:10] = np.nan
    fitted = sm.motion_fit(points, TIME).velocity
    assert np.isnan(fitted[:11]).all()
    assert np.isfinite(fitted[11:]).all()
    assert np.isnan(sm.line_fit(points)[0][:11]).all()


def test_a_record_without_a_single_position_gives_nothing_and_no_warning():
    nothing = np.full((5, 2), np.nan)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.isnan(sm.line_fit(nothing)).all()
        assert np.isnan(sm.orthogonal_line_fit(nothing)[1]).all()
        assert np.isnan(sm.motion_fit(nothing, np.arange(5.0)).velocity).all()


def test_a_span_may_be_any_whole_number_and_positions_a_list(points):
    whole, read = (sm.motion_fit(points[0], TIME, span=span).velocity for span in (10, 10.0))
    np.testing.assert_array_equal(read, whole)
    assert sm.slant_range([[30.0, 40.0]], 120.0) == pytest.approx(130.0)
    np.testing.assert_allclose(sm.position_precision([0.0, 0.0], 10.0, 0.1), np.eye(2))


def test_spans_that_leave_the_record_are_nan():
    points = PAPER.motion.position(TIME)
    trailing = np.isnan(sm.motion_fit(points, TIME, span=10).velocity[:, 0])
    centred = np.isnan(sm.motion_fit(points, TIME, span=11, centred=True).velocity[:, 0])
    np.testing.assert_array_equal(np.flatnonzero(trailing), np.arange(9))
    np.testing.assert_array_equal(np.flatnonzero(centred), [*range(5), *range(115, 120)])


def test_an_even_span_is_centred_at_the_start_of_its_window(points):
    fitted = sm.motion_fit(points[0], TIME, span=10, centred=True).velocity
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(fitted[:, 0])), [*range(5), *range(116, 120)])
    used = slice(40 - 5, 40 + 5)
    assert np.mean(TIME[used]) == pytest.approx(TIME[40] - WINDOW / 2)
    np.testing.assert_allclose(fitted[40], np.polyfit(TIME[used], points[0, used], 1)[0], rtol=1e-9)


def test_the_first_difference_is_not_an_estimate():
    assert np.isnan(sm.difference_velocity(PAPER.motion.position(TIME), WINDOW)[0]).all()


def test_directions_that_do_not_meet_the_surface_have_no_position():
    assert np.isnan(sm.position(0.0, [np.pi / 2, 2.0, np.nan, -0.1], DEPTH)).all()
    np.testing.assert_allclose(sm.position(0.3, 0.0, DEPTH), 0)


def test_a_track_along_y_defeats_the_line_but_not_the_orthogonal_line():
    points = np.stack([np.zeros(20), np.arange(20.0)], axis=-1)
    assert np.isnan(sm.line_fit(points)[0]).all()
    velocity = sm.orthogonal_fit_velocity(points, 0.5)[1:]
    np.testing.assert_allclose(velocity, np.tile([0.0, 2.0], (19, 1)), atol=1e-12)


# Bad input

LINE = PAPER.motion.position(TIME)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: sm.position(0.0, 0.5, 0.0), "depth must be above 0, but 0 was given"),
        (lambda: sm.position(0.0, 0.5, np.nan), "depth must be finite"),
        (lambda: sm.slant_range(LINE, -1.0), "depth must be above 0"),
        (lambda: sm.slant_range([1.0, 2.0, 3.0], DEPTH), "position must have shape (..., 2"),
        (lambda: sm.position_precision([1.0], DEPTH, 0.1), "position must have shape (..., 2"),
        (lambda: sm.emission_time(LINE, TIME, DEPTH, 0.0), "sound_speed must be above 0"),
        (lambda: sm.emission_time(LINE, TIME[:-1], DEPTH, SOUND_SPEED), "time must have shape"),
        (lambda: sm.difference_velocity(LINE, 0.0), "window must be above 0"),
        (lambda: sm.difference_velocity(LINE[:, 0], WINDOW), "position must have shape"),
        (lambda: sm.line_fit(LINE[:, :1]), "position must have shape"),
        (lambda: sm.orthogonal_fit_velocity(LINE, -0.5), "window must be above 0"),
        (lambda: sm.position_precision(LINE, DEPTH, 0.0), "angle_error must be above 0"),
        (lambda: sm.motion_fit(LINE, TIME[1:]), "time must have shape"),
        (lambda: sm.motion_fit(LINE, TIME, np.eye(3)), "precision must have shape"),
        (lambda: sm.motion_fit(LINE, TIME, span=1), "span must be a whole number from 2 to 120, but 1"),
        (lambda: sm.motion_fit(LINE, TIME, span=121), "but 121 was given"),
        (lambda: sm.motion_fit(LINE, TIME, span=2.5), "but 2.5 was given"),
        (lambda: sm.motion_fit(LINE, np.full(120, 3.0)), "time must differ"),
        (lambda: sm.motion_bound(LINE, TIME[1:], DEPTH, 0.1), "time must have shape"),
        (lambda: sm.motion_bound(LINE, TIME, DEPTH, np.inf), "angle_error must be finite"),
        (
            lambda: sm.maximum_likelihood_motion(AZIMUTH, ANGLE[1:], TIME, DEPTH, SOUND_SPEED, ERROR),
            "angle_from_vertical must have shape",
        ),
        (
            lambda: sm.maximum_likelihood_motion(AZIMUTH, ANGLE, TIME, DEPTH, SOUND_SPEED, -ERROR),
            "angle_error must be above 0",
        ),
        (lambda: sm.along_and_across([1.0, 2.0, 3.0], 0.0), "vector must have shape"),
    ],
)
def test_bad_input_is_refused_in_words(call, words):
    with pytest.raises(ValueError, match=words.replace("(", r"\(")):
        call()
