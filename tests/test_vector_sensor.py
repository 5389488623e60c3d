"""The vector sensor against geometry, theory, the Cramer-Rao bound and independent computations.

Monte Carlo tolerances are given as a number of standard errors. An RMSE over n independent errors has
the relative standard error 1/sqrt(2n): 1.1 % for the 4000 trials used here unless a test says otherwise.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import simpson
from scipy.io import wavfile

from labsim.metrics import angle_difference, angle_rmse, rmse
from labsim.motion import retarded_time, straight_track, waypoint_track
from labsim.noise import power_ratio
from labsim.vector_sensor import (
    PassingVessel,
    averaged_intensity,
    best_window,
    bisector_lag,
    closest_approach,
    cramer_rao_bound,
    direction_of_arrival,
    expected_error,
    geometry,
    intensity_error,
    load_recording,
    maximum_likelihood_direction,
    one_window,
    record,
    sample_covariance,
    sample_intensity,
    snr,
    static_source,
    unit_vector,
    window_bisector,
    window_centres,
)

TRIALS = 4000
AZIMUTH, ANGLE = np.radians(40), np.radians(60)


def rng(seed=20):
    return np.random.default_rng(seed)


def static_rmse_deg(directions):
    azimuth, angle = directions
    return np.degrees(angle_rmse(azimuth.ravel(), AZIMUTH)), np.degrees(angle_rmse(angle.ravel(), ANGLE))


def turning_track():
    return waypoint_track([-5.0, 20.0, 40.0, 70.0], [(-300, 100), (-20, 140), (150, 60), (150, -250)])


# --- geometry ---


def test_closest_approach_of_the_paper_seen_without_delay():
    time = np.linspace(0, 60, 60001)
    seen = geometry(PassingVessel(), time, retarded=False)
    nearest = np.argmin(seen.slant_range)
    assert time[nearest] == pytest.approx(19.07, abs=0.01)
    assert seen.slant_range[nearest] == pytest.approx(173.6, abs=0.05)
    assert np.degrees(seen.angle_from_vertical[nearest]) == pytest.approx(54.8, abs=0.05)
    assert seen.slant_range[-1] == pytest.approx(520.9, abs=0.05)


@given(
    start=st.tuples(st.floats(-2000, 2000), st.floats(-2000, 2000)),
    speed=st.floats(0, 300),
    heading=st.floats(-np.pi, np.pi),
    time=st.floats(0, 60),
)
def test_sound_travels_exactly_from_where_the_source_was(start, speed, heading, time):
    vessel = PassingVessel(start=start, speed=speed, heading=heading)
    heard = geometry(vessel, time)
    velocity = speed * np.array([np.cos(heading), np.sin(heading)])
    b, q = start @ velocity + 1500**2 * time, 1500**2 - speed**2
    distance2 = np.sum(np.square(start)) + 100**2
    emitted = (b - np.sqrt(b**2 - q * (1500**2 * time**2 - distance2))) / q
    np.testing.assert_allclose(heard.position, start + velocity * emitted, atol=1e-6)
    assert heard.slant_range == pytest.approx(1500 * (time - emitted), abs=1e-6)


def test_sound_of_a_turning_vessel_travels_exactly():
    vessel = PassingVessel(track=turning_track())
    time = np.linspace(0, 60, 200)
    emitted = retarded_time(vessel.track, 100.0, time, 1500.0)
    heard = geometry(vessel, time)
    np.testing.assert_allclose(heard.slant_range, 1500 * (time - emitted), atol=1e-6)
    np.testing.assert_allclose(heard.position, vessel.track.position(emitted), atol=1e-6)


def test_the_delay_of_the_paper_is_a_third_of_a_second_and_four_metres():
    vessel = PassingVessel()
    heard, now = geometry(vessel, 60.0), geometry(vessel, 60.0, retarded=False)
    assert heard.slant_range / 1500 == pytest.approx(0.345, abs=0.001)
    assert 60.0 - heard.emitted == pytest.approx(heard.slant_range / 1500, abs=1e-9)
    assert now.emitted == 60.0
    assert np.linalg.norm(now.position - heard.position) == pytest.approx(4.1, abs=0.05)


def test_direction_points_from_the_sensor_to_the_source():
    heard = geometry(PassingVessel(), np.linspace(0, 60, 50))
    place = np.insert(heard.position, 2, 100.0, axis=-1)
    np.testing.assert_allclose(heard.direction, place / heard.slant_range[:, None], rtol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(place, axis=-1), heard.slant_range)
    azimuth, angle = direction_of_arrival(heard.direction)
    np.testing.assert_allclose(azimuth, heard.azimuth, atol=1e-12)
    np.testing.assert_allclose(angle, heard.angle_from_vertical, atol=1e-12)
    np.testing.assert_allclose(100 * np.tan(angle), np.linalg.norm(heard.position, axis=-1))


def test_closest_approach_as_heard_comes_later_by_the_travel_time():
    closest = closest_approach(PassingVessel())
    velocity = np.array([np.cos(np.pi / 18), np.sin(np.pi / 18)])
    assert closest.slant_range == pytest.approx(173.59, abs=0.005)
    assert closest.position @ velocity == pytest.approx(0, abs=1e-4)
    assert closest.time == pytest.approx(19.07 + 173.59 / 1500, abs=0.005)


@pytest.mark.parametrize("shift", np.linspace(0.0, 0.7, 8))
def test_closest_approach_is_square_to_the_course_wherever_it_falls_between_grid_points(shift):
    closest = closest_approach(PassingVessel(start=(-250.0 + shift, 100.0), heading=0.0))
    assert closest.position[0] == pytest.approx(0, abs=1e-4)


def test_closest_approach_of_a_turning_vessel_is_its_nearest_point():
    vessel = PassingVessel(track=turning_track())
    assert closest_approach(vessel).slant_range == pytest.approx(
        geometry(vessel, np.linspace(0, 60, 20001)).slant_range.min(), rel=1e-8
    )


def test_closest_approach_outside_the_record_is_at_its_edge():
    assert closest_approach(PassingVessel(duration=5.0)).time == pytest.approx(5.0)


def test_a_track_replaces_start_speed_and_heading():
    straight = PassingVessel()
    track = straight_track((-250.0, 100.0), 12.0, np.pi / 18)
    tracked = PassingVessel(track=track, start=(0.0, 0.0), speed=1.0)
    time = np.linspace(0, 60, 20)
    np.testing.assert_allclose(geometry(tracked, time).direction, geometry(straight, time).direction)


def test_snr_falls_with_the_square_of_the_distance_from_the_closest_approach():
    # By hand, without delay: the vessel starts 500 m away (300, 400, 0 aside) and is 300 m away overhead.
    vessel = PassingVessel(
        sensor_depth=300.0, start=(-400.0, 0.0), speed=10.0, heading=0.0, sound_speed=1e9, snr_db=20.0
    )
    np.testing.assert_allclose(snr(vessel, [0.0, 40.0]), [36.0, 100.0], rtol=1e-6)


@pytest.mark.parametrize("duration", [16.0, 48.0])
def test_averaged_direction_is_the_bisector_of_the_end_directions(duration):
    """Exact when nothing is delayed: sound of 1e9 m/s; quadrature of a / r^2 as the independent way."""
    vessel = PassingVessel(window=duration, sound_speed=1e9)
    time = np.linspace(0, duration, 8001)
    seen = geometry(vessel, time)
    flow = simpson(seen.direction / seen.slant_range[:, None] ** 2, x=time, axis=0)
    angle = np.arccos(np.clip(flow @ window_bisector(vessel)[0] / np.linalg.norm(flow), -1, 1))
    assert np.degrees(angle) < 2e-6


def test_retardation_moves_the_averaged_direction_from_the_bisector_by_hundredths_of_a_degree():
    vessel = PassingVessel(window=16.0)
    time = np.linspace(0, 16, 8001)
    seen = geometry(vessel, time)
    flow = simpson(seen.direction / seen.slant_range[:, None] ** 2, x=time, axis=0)
    angle = np.arccos(np.clip(flow @ window_bisector(vessel)[0] / np.linalg.norm(flow), -1, 1))
    assert 1e-3 < np.degrees(angle) < 0.03


# --- estimators ---


def test_averaged_intensity_is_a_mean_of_products_for_any_batch():
    pressure, velocity = rng().normal(size=(2, 5, 103)), rng(21).normal(size=(2, 5, 103, 3))
    intensity = averaged_intensity(pressure, velocity, 20)
    assert intensity.shape == (2, 5, 5, 3)
    by_hand = np.mean(pressure[1, 3, 40:60, None] * velocity[1, 3, 40:60], axis=0)
    np.testing.assert_allclose(intensity[1, 3, 2], by_hand)


@given(st.floats(-3.1, 3.1), st.floats(0.01, 3.1), st.floats(1e-6, 1e6))
def test_direction_of_arrival_finds_every_quadrant_at_any_level(azimuth, angle, level):
    found = direction_of_arrival(level * unit_vector(azimuth, angle))
    np.testing.assert_allclose(found, (azimuth, angle), atol=1e-9)


def test_a_zero_intensity_has_no_direction():
    azimuth, angle = direction_of_arrival([[0, 0, 0], [0, 1, 0], [np.nan, 1, 1]])
    np.testing.assert_array_equal(np.isnan(azimuth), [True, False, True])
    np.testing.assert_array_equal(np.isnan(angle), [True, False, True])


def random_covariance(seed, batch=()):
    factor = rng(seed).normal(size=(*batch, 4, 9))
    return factor @ np.swapaxes(factor, -1, -2) / 9


@given(st.integers(0, 10**6), st.floats(0.01, 100))
def test_no_direction_is_more_likely_than_the_maximum_likelihood_direction(seed, ratio):
    covariance = random_covariance(seed)
    others = rng(seed).normal(size=(2000, 3))
    others /= np.linalg.norm(others, axis=-1, keepdims=True)

    def likelihood(a):
        quadratic = np.einsum("...i,ij,...j->...", a, covariance[1:, 1:], a)
        return quadratic + 2 * ratio * a @ covariance[0, 1:]

    azimuth, angle = maximum_likelihood_direction(covariance, ratio)
    best = unit_vector(azimuth, angle)
    assert likelihood(best) >= likelihood(others).max() - 1e-9 * abs(likelihood(best))


def test_maximum_likelihood_takes_any_batch_and_has_no_direction_without_intensity():
    covariance = random_covariance(3, (2, 5))
    azimuth, angle = maximum_likelihood_direction(covariance)
    assert azimuth.shape == angle.shape == (2, 5)
    assert azimuth[1, 2] == pytest.approx(float(maximum_likelihood_direction(covariance[1, 2])[0]))
    assert np.isnan(maximum_likelihood_direction(np.eye(4))).all()


@pytest.mark.parametrize("unknown", [np.nan, np.inf])
def test_an_unknown_covariance_has_no_direction_and_leaves_the_others_theirs(unknown):
    covariance = random_covariance(5, (4,))
    expected = np.array(maximum_likelihood_direction(covariance))
    covariance[1, 2, 3] = unknown
    expected[:, 1] = np.nan
    np.testing.assert_allclose(maximum_likelihood_direction(covariance), expected, rtol=1e-12)


def test_intensity_is_the_likeliest_direction_when_pressure_is_free_of_noise():
    covariance = random_covariance(4, (50,))
    likeliest = maximum_likelihood_direction(covariance, 1e9)
    np.testing.assert_allclose(likeliest, direction_of_arrival(covariance[:, 0, 1:]), atol=1e-6)


@pytest.mark.parametrize("scale", [1e-200, 1.0, 1e200])
@pytest.mark.parametrize("cross", [(0.3, 0.0, 0.0), (0.3, 0.4, 0.0), (0.0, 0.2, 1e-15), (0.3, 0.4, -1e-14)])
def test_maximum_likelihood_of_an_intensity_across_the_long_axis(cross, scale):
    """The long axis of the velocities is z and the intensity lies across it: the likeliest direction leans
    towards z, up or down alike, as lambda = the largest eigenvalue says; a fine grid finds nothing better."""
    covariance = np.diag([2.0, 0.5, 1.0, 3.0])
    covariance[0, 1:] = covariance[1:, 0] = cross
    azimuth, angle = maximum_likelihood_direction(scale * covariance)
    across = np.array(cross[:2]) / [2.5, 2.0]
    assert np.sin(angle) == pytest.approx(np.linalg.norm(across), abs=1e-6)
    assert azimuth == pytest.approx(np.arctan2(across[1], across[0]), abs=1e-6)
    assert np.cos(angle) < 0 if cross[2] < 0 else np.cos(angle) > 0


def test_maximum_likelihood_takes_ordinary_and_hard_cases_in_one_batch():
    hard = np.diag([2.0, 0.5, 1.0, 3.0])
    hard[0, 1] = hard[1, 0] = 0.3
    batch = np.stack([random_covariance(3), hard, np.zeros((4, 4))])
    azimuth, angle = maximum_likelihood_direction(batch)
    for k in (0, 1):
        assert (azimuth[k], angle[k]) == pytest.approx(maximum_likelihood_direction(batch[k]))
    assert np.isnan(azimuth[2])


# --- errors against theory and bound ---


@pytest.mark.parametrize(("snr_db", "azimuth_deg", "angle_deg"), [(10, 0.896, 0.776), (20, 0.271, 0.235)])
def test_static_source_has_the_expected_error(snr_db, azimuth_deg, angle_deg):
    """The numbers of the closed form, and 3.5 standard errors of 1.1 % for the Monte Carlo (seed 21)."""
    sigma = np.degrees(intensity_error(power_ratio(snr_db), 300))
    assert (sigma / np.sin(ANGLE), sigma) == pytest.approx((azimuth_deg, angle_deg), abs=5e-4)
    source = static_source(AZIMUTH, ANGLE, snr_db=snr_db)
    measured = static_rmse_deg(direction_of_arrival(sample_intensity(source, rng(21), TRIALS)))
    assert measured == pytest.approx((azimuth_deg, angle_deg), rel=3.5 * 0.0112)


@pytest.mark.parametrize("ratio", [1 / 3, 1.0, 10.0])
@pytest.mark.parametrize("snr_db", [-3, 0, 5, 10, 20, 30])
def test_the_bound_is_met_from_above(snr_db, ratio):
    """Intensity and maximum likelihood stay above the bound less 3.5 standard errors; the likeliest
    direction also comes within 5 % + 3.5 standard errors of it wherever the bound is below 3 degrees."""
    source = static_source(AZIMUTH, ANGLE, snr_db=snr_db, velocity_noise_ratio=ratio)
    covariance = sample_covariance(source, rng(22), TRIALS, blocks=1)
    bound = np.degrees(cramer_rao_bound(power_ratio(snr_db), 300, ratio)) / np.array([np.sin(ANGLE), 1])
    margin = 3.5 * 0.0112
    by_intensity = static_rmse_deg(direction_of_arrival(covariance[..., 0, 1:]))
    likeliest = static_rmse_deg(maximum_likelihood_direction(covariance, ratio))
    assert np.all(by_intensity > bound * (1 - margin))
    assert np.all(likeliest > bound * (1 - margin))
    if bound[1] < 3:
        assert np.all(likeliest < bound * (1.05 + margin))


def test_the_expected_error_of_a_passing_vessel_takes_all_its_noises():
    # By hand: 20 dB (100) abeam, Nv / Np = 2, B T = 100: sqrt(2 / 100 * 1.01 / 200).
    vessel = PassingVessel(snr_db=20.0, velocity_noise_ratio=2.0, band=(200.0, 400.0))
    error = expected_error(vessel, closest_approach(vessel).time)
    assert error == pytest.approx(np.sqrt(1.01e-4), rel=1e-6)


def test_the_closed_form_lies_above_the_bound_everywhere():
    level, ratio = np.meshgrid(np.logspace(-4, 6, 60), np.logspace(-3, 3, 30))
    assert np.all(intensity_error(level, 300, ratio) >= cramer_rao_bound(level, 300, ratio))


@given(st.floats(1e-2, 1e2))
def test_efficiency_tends_to_one_at_high_and_to_the_noise_ratio_at_low_snr(ratio):
    def excess(level):
        return (intensity_error(level, 300, ratio) / cramer_rao_bound(level, 300, ratio)) ** 2

    assert excess(1e7) == pytest.approx(1, abs=1e-4)
    assert excess(1e-7) == pytest.approx(1 + 1 / ratio, rel=1e-4)


@pytest.mark.parametrize(("snr_db", "ratio"), [(-10, 1.0), (0, 1 / 3), (12, 4.0)])
def test_the_bound_agrees_with_the_information_matrix_of_all_unknowns(snr_db, ratio):
    """Trace formula (K/2) tr(R^-1 dR R^-1 dR) with azimuth, angle, S, Np, Nv unknown; central differences."""

    def covariance(unknown):
        azimuth, angle, signal, noise, velocity_noise = unknown
        a = [np.cos(azimuth) * np.sin(angle), np.sin(azimuth) * np.sin(angle), np.cos(angle)]
        h = np.array([1.0, *a])
        return signal * np.outer(h, h) + np.diag([noise, velocity_noise, velocity_noise, velocity_noise])

    truth = np.array([AZIMUTH, ANGLE, power_ratio(snr_db), 1.0, ratio])
    step = 1e-5
    slopes = [(covariance(truth + step * e) - covariance(truth - step * e)) / (2 * step) for e in np.eye(5)]
    weighted = [np.linalg.solve(covariance(truth), slope) for slope in slopes]
    information = 300 * np.array([[np.trace(one @ other) for other in weighted] for one in weighted])
    sigma = np.sqrt(np.diag(np.linalg.inv(information)))[:2]
    bound = cramer_rao_bound(power_ratio(snr_db), 300, ratio)
    np.testing.assert_allclose(sigma, [bound / np.sin(ANGLE), bound], rtol=1e-6)


@pytest.mark.parametrize("bandwidth", [50, 200, 1200])
def test_the_error_falls_with_the_root_of_bandwidth(bandwidth):
    """10 dB, seed 24; 3.5 standard errors of 1.1 %, and 2.5 % for the curvature of the sphere at 50 Hz."""
    source = static_source(AZIMUTH, ANGLE, snr_db=10, band=(200, 200 + bandwidth))
    measured = static_rmse_deg(direction_of_arrival(sample_intensity(source, rng(24), TRIALS)))
    sigma = np.degrees(intensity_error(10, bandwidth / 2))
    assert measured == pytest.approx((sigma / np.sin(ANGLE), sigma), rel=3.5 * 0.0112 + 0.025)


def test_the_best_window_has_the_least_error():
    sigma, acceleration = np.radians(0.4), np.radians(0.2)
    windows = np.linspace(0.5, 5, 100001)
    square = sigma**2 / windows + (acceleration * windows**2 / 8) ** 2
    assert best_window(sigma, -acceleration) == pytest.approx(windows[np.argmin(square)], abs=1e-3)


def test_the_error_of_a_moving_source_has_its_minimum_at_the_best_window():
    """14 dB, about t = 10 s, azimuth against the truth at the middle, 2000 trials, seed 26: the bias to 4
    standard errors and 2 %, the RMSE to 4 standard errors of 1.6 % and 3 % for the self-noise."""
    vessel = PassingVessel()
    sigma = intensity_error(snr(vessel, 10.0), 600) / np.sin(geometry(vessel, 10.0).angle_from_vertical)
    acceleration = 800 * bisector_lag(vessel, 10.0, 0.1)[0]
    assert best_window(sigma, acceleration) == pytest.approx(2.4, abs=0.1)
    for window, expected in ((1.0, 0.451), (2.0, 0.341), (4.0, 0.452)):
        error = azimuth_error_about_ten_seconds(window)
        bias = bisector_lag(vessel, 10.0, window)[0]
        standard_error = error.std() / np.sqrt(error.size)
        assert error.mean() == pytest.approx(bias, abs=4 * standard_error + 0.02 * abs(bias))
        assert rmse(error) == pytest.approx(np.hypot(sigma / np.sqrt(window), bias), rel=4 * 0.016 + 0.03)
        assert np.degrees(rmse(error)) == pytest.approx(expected, rel=4 * np.sqrt(2) * 0.016)


def azimuth_error_about_ten_seconds(window, trials=2000):
    """Azimuth of one window centred at 10 s less the true one there, (trials,); blocks of 0.1 s."""
    part = one_window(PassingVessel(), 10.0, window)
    azimuth, _ = direction_of_arrival(sample_intensity(part, rng(26), trials, blocks=int(10 * window)))
    return angle_difference(azimuth[:, 0], geometry(PassingVessel(), 10.0).azimuth)


@pytest.mark.parametrize("fields", [{}, {"track": turning_track()}])
def test_one_window_of_a_record_is_the_same_world(fields):
    vessel = PassingVessel(**fields)
    part = one_window(vessel, 30.0, 4.0)
    time = np.linspace(0, 4, 9)
    there = geometry(vessel, time + 28).direction
    np.testing.assert_allclose(geometry(part, time).direction, there, atol=1e-9)
    np.testing.assert_allclose(snr(part, time), snr(vessel, time + 28), rtol=1e-9)


# --- waveforms and the fast sampler ---


def test_the_fast_sampler_and_the_waveforms_of_a_static_source_agree():
    """0 dB: 800 windows of waveform (seed 34), 20000 draws; means and variances to 4 standard errors."""
    source = static_source(AZIMUTH, ANGLE, snr_db=0, duration=400.0, sample_rate=2000.0)
    heard = record(source, rng(34))
    waves = averaged_intensity(heard.pressure, heard.velocity, source.samples_per_window)
    drawn = sample_intensity(replace(source, duration=0.5), rng(35), 20000)[:, 0]
    assert waves.shape == (800, 3)
    error = drawn.std(axis=0) / np.sqrt(800)
    np.testing.assert_array_less(np.abs(waves.mean(axis=0) - drawn.mean(axis=0)), 4 * error)
    np.testing.assert_allclose(waves.var(axis=0), drawn.var(axis=0), rtol=4 * np.sqrt(2 / 800))
    waves_rmse = static_rmse_deg(direction_of_arrival(waves))
    drawn_rmse = static_rmse_deg(direction_of_arrival(drawn))
    np.testing.assert_allclose(waves_rmse, drawn_rmse, rtol=4 / np.sqrt(1600))


def test_the_fast_sampler_and_the_waveforms_of_the_passing_vessel_agree():
    """14 dB, 17 to 21 s, 60 records of 8 windows (seed 36): RMSE to 4 standard errors, 3.2 % each."""
    vessel = PassingVessel()
    records = [record(vessel, generator, (17.0, 21.0)) for generator in rng(36).spawn(60)]
    pressure, velocity = (np.stack([getattr(r, name) for r in records]) for name in ("pressure", "velocity"))
    truth = geometry(vessel, window_centres(vessel)[34:42])
    waves = direction_of_arrival(averaged_intensity(pressure, velocity, vessel.samples_per_window))
    drawn = direction_of_arrival(sample_intensity(vessel, rng(37), 500)[:, 34:42])
    for angle, other, right in zip(waves, drawn, (truth.azimuth, truth.angle_from_vertical), strict=True):
        measured = angle_rmse(angle, right, axis=None)
        assert measured == pytest.approx(angle_rmse(other, right, axis=None), rel=4 * 0.032)


def test_motion_alone_spreads_the_direction_of_a_noise_like_source():
    """At 80 dB only the source's own envelope is left: rate sqrt(T / 12 B); 4000 draws, 4 standard errors
    of 1.1 % and 2 % for the blocks (1 - 1/25); 120 waveform windows (seed 38) to 4 of 6.5 %."""
    vessel = PassingVessel(snr_db=80.0)
    rate = np.diff(geometry(vessel, [19.2, 19.3]).azimuth)[0] / 0.1
    expected = abs(rate) * np.sqrt(0.5 / (12 * 600))
    drawn, _ = direction_of_arrival(sample_intensity(vessel, rng(39), TRIALS)[:, 38])
    assert np.std(drawn) == pytest.approx(expected, rel=4 * 0.0112 + 0.02)
    records = [record(vessel, generator, (19.0, 19.5)) for generator in rng(38).spawn(120)]
    waves = [averaged_intensity(r.pressure, r.velocity, 3000)[0] for r in records]
    assert np.std(direction_of_arrival(waves)[0]) == pytest.approx(expected, rel=4 * 0.065)


def test_without_noise_the_sampled_intensity_points_along_the_bisector():
    """200 trials, seed 40; the mean over trials to 4 standard errors of at most 0.041 degrees / sqrt(200)."""
    vessel = PassingVessel(snr_db=120.0)
    intensity = sample_intensity(vessel, rng(40), 200).mean(axis=0)
    cosine = np.sum(intensity * window_bisector(vessel), axis=-1) / np.linalg.norm(intensity, axis=-1)
    assert np.degrees(np.arccos(np.clip(cosine, -1, 1))).max() < 4 * 0.041 / np.sqrt(200)


def test_covariances_and_intensities_are_drawn_from_one_law():
    """5 dB, 4000 draws of each: means and variances to 4 standard errors of their difference."""
    source = static_source(AZIMUTH, ANGLE, snr_db=5, velocity_noise_ratio=0.5)
    from_covariance = sample_covariance(source, rng(41), TRIALS)[:, 0, 0, 1:]
    drawn = sample_intensity(source, rng(42), TRIALS)[:, 0]
    error = drawn.std(axis=0) * np.sqrt(2 / TRIALS)
    np.testing.assert_array_less(np.abs(from_covariance.mean(axis=0) - drawn.mean(axis=0)), 4 * error)
    np.testing.assert_allclose(from_covariance.var(axis=0), drawn.var(axis=0), rtol=4 * np.sqrt(4 / TRIALS))


def test_the_mean_covariance_is_that_of_the_model():
    source = static_source(AZIMUTH, ANGLE, snr_db=5, velocity_noise_ratio=0.5)
    mean = sample_covariance(source, rng(43), TRIALS)[:, 0].mean(axis=0)
    h = np.array([1, *geometry(source, 0.0).direction])
    noise = 1 / power_ratio(5)
    truth = np.outer(h, h) + noise * np.diag([1, 0.5, 0.5, 0.5])
    np.testing.assert_allclose(mean, truth, atol=4 * np.sqrt(2) * 1.4 / np.sqrt(600 * TRIALS))


def test_the_recording_has_the_power_of_signal_and_noise():
    """Four standard errors of the mean square of 2 B T = 4800 independent values, 2 %, times 4."""
    vessel = PassingVessel(snr_db=3.0)
    heard = record(vessel, rng(44), (17.2, 21.2))
    noise = 1 / power_ratio(3)
    assert np.mean(heard.pressure**2) == pytest.approx(1 + noise, rel=0.09)
    assert np.mean(np.sum(heard.velocity**2, axis=-1)) == pytest.approx(1 + 3 * noise, rel=0.09)


@pytest.mark.parametrize("channel", ["pressure", "velocity"])
def test_recorded_power_falls_with_the_square_of_the_distance(channel):
    # Seed 31, one record of 120 windows with B T = 300 each and noise 60 dB down: the power in a window
    # scatters by 1/sqrt(B T), and the mean over the windows by 1/sqrt(120 B T); five of each are allowed.
    vessel = PassingVessel(snr_db=60.0)
    wave = getattr(record(vessel, np.random.default_rng(31)), channel)
    power = (wave.reshape(vessel.samples, -1) ** 2).sum(axis=1).reshape(vessel.windows, -1).mean(axis=1)
    distance = geometry(vessel, window_centres(vessel)).slant_range
    relative = power / (closest_approach(vessel).slant_range / distance) ** 2
    assert distance.max() > 2 * distance.min()
    assert np.mean(relative) == pytest.approx(1, abs=5 / np.sqrt(120 * vessel.time_bandwidth))
    assert np.max(np.abs(relative - 1)) < 5 / np.sqrt(vessel.time_bandwidth)


def test_the_velocity_channels_have_their_own_noise():
    """Seed 48, 0 dB, velocity noise 4 times that of pressure: 2 s, 2 B T = 2400, four standard errors."""
    vessel = PassingVessel(snr_db=0.0, velocity_noise_ratio=4.0)
    heard = record(vessel, rng(48), (18.2, 20.2))
    assert np.mean(heard.pressure**2) == pytest.approx(2.0, rel=4 * 0.029)
    expected = 4 + geometry(vessel, 19.2).direction ** 2
    np.testing.assert_allclose(np.mean(heard.velocity**2, axis=0), expected, rtol=4 * 0.029)


def gaussian_covariances(source, freedom, trials, generator):
    """Sample covariances of `freedom` independent Gaussian samples of (p, v), made one by one."""
    noise = 1 / power_ratio(source.snr_db) * np.array([1, *[source.velocity_noise_ratio] * 3])
    h = np.array([1, *geometry(source, 0.0).direction])
    samples = generator.normal(size=(trials, freedom, 1)) * h
    samples += generator.normal(size=(trials, freedom, 4)) * np.sqrt(noise)
    return np.einsum("tki,tkj->tij", samples, samples) / freedom


def moments(values):
    """Variance and kurtosis along axis 0 with their standard errors from 40 batches: ((2, ...), (2, ...))."""
    batches = values.reshape(40, -1, *values.shape[1:])
    offset = batches - batches.mean(axis=1, keepdims=True)
    square = np.mean(offset**2, axis=1)
    both = np.stack([square, np.mean(offset**4, axis=1) / square**2])
    return both.mean(axis=1), both.std(axis=1) / np.sqrt(40)


@pytest.mark.parametrize("blocks", [1, 2])
def test_few_degrees_of_freedom_are_drawn_as_from_single_samples(blocks):
    """2 B T = 10 at 3 dB, 40000 draws each (seeds 62 to 64): variances and kurtoses to 4.5 standard errors of
    the difference; the mean determinant, det C (K-1)(K-2)(K-3)/K^3, tells the degrees of the Wishart law."""
    source = static_source(AZIMUTH, ANGLE, snr_db=3, velocity_noise_ratio=0.5, band=(200, 210))
    direct = gaussian_covariances(source, 10, 40_000, rng(62))
    wishart = sample_covariance(source, rng(63), 40_000, blocks=blocks)[:, 0]
    expected, error = moments(direct)
    for drawn in (wishart[:, 0, 1:], sample_intensity(source, rng(64), 40_000, blocks=blocks)[:, 0]):
        found, doubt = moments(drawn)
        miss = np.abs(found - expected[..., 0, 1:]) / np.hypot(doubt, error[..., 0, 1:])
        assert miss.max() < 4.5
    determinants = np.linalg.det(wishart), np.linalg.det(direct)
    miss = np.subtract(*[np.mean(values) for values in determinants])
    assert abs(miss) < 4 * np.hypot(*[np.std(values) / 200 for values in determinants])


def test_the_recording_of_an_approaching_vessel_is_shifted_up_in_frequency():
    """Straight at the sensor at 100 m/s: a line of 500 Hz is heard at 500 / (1 - 100/1500) Hz, 535.7."""
    vessel = PassingVessel(
        sensor_depth=0.1,
        start=(-3000.0, 0.0),
        speed=100.0,
        heading=0.0,
        duration=10.0,
        band=(499.0, 501.0),
        snr_db=40.0,
    )
    heard = record(vessel, rng(45))
    spectrum = np.abs(np.fft.rfft(heard.pressure * np.hanning(heard.pressure.size))) ** 2
    frequency = np.fft.rfftfreq(heard.pressure.size, 1 / 6000)
    loud = (frequency > 505) & (frequency < 700)
    centre = np.sum(frequency[loud] * spectrum[loud]) / np.sum(spectrum[loud])
    assert centre == pytest.approx(500 / (1 - 100 / 1500), abs=1.0)


def test_an_interval_of_the_record_is_heard_at_its_own_times():
    heard = record(PassingVessel(), rng(), (10.0, 10.5))
    assert heard.time[0] == 10.0 and heard.time.size == heard.pressure.size == 3000
    assert heard.velocity.shape == (3000, 3)


def test_a_band_up_to_half_the_sample_rate_is_recorded():
    vessel = PassingVessel(sample_rate=2000.0, band=(100.0, 1000.0), snr_db=60.0)
    heard = record(vessel, rng(46), (18.0, 21.0))
    azimuth, _ = direction_of_arrival(averaged_intensity(heard.pressure, heard.velocity, 1000))
    truth = geometry(vessel, window_centres(vessel)[36:42]).azimuth
    np.testing.assert_allclose(azimuth, truth, atol=np.radians(0.3))


# --- invariance ---


def estimates(scenario):
    heard = record(scenario, rng(50))
    intensity = averaged_intensity(heard.pressure, heard.velocity, scenario.samples_per_window)
    return direction_of_arrival(intensity)


def short_vessel(**fields):
    base = {"duration": 1.0, "snr_db": 150.0, "start": (-80.0, 60.0), "speed": 40.0}
    return PassingVessel(**(base | fields))


@settings(max_examples=20, deadline=None)
@given(st.floats(-np.pi, np.pi))
def test_turning_the_world_turns_the_azimuths_alone(turn):
    vessel = short_vessel()
    x, y = vessel.start
    start = (np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y)
    azimuth, angle = estimates(vessel)
    turned_azimuth, turned_angle = estimates(replace(vessel, start=start, heading=vessel.heading + turn))
    np.testing.assert_allclose(angle_difference(turned_azimuth, azimuth + turn), 0, atol=1e-6)
    np.testing.assert_allclose(turned_angle, angle, atol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.floats(-200, 200), st.floats(1, 200), st.floats(-np.pi, np.pi))
def test_mirroring_the_world_mirrors_the_azimuths_alone(x, y, heading):
    vessel = short_vessel(start=(x, y), heading=heading)
    azimuth, angle = estimates(vessel)
    mirrored_azimuth, mirrored_angle = estimates(replace(vessel, start=(x, -y), heading=-heading))
    np.testing.assert_allclose(angle_difference(mirrored_azimuth, -azimuth), 0, atol=1e-6)
    np.testing.assert_allclose(mirrored_angle, angle, atol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.floats(0.2, 5))
def test_scaling_lengths_and_times_together_changes_no_angle(factor):
    vessel = short_vessel(snr_db=10.0, band=(200.3, 800.3))
    scaled = replace(
        vessel,
        sensor_depth=100 * factor,
        start=(-80.0 * factor, 60.0 * factor),
        duration=1.0 * factor,
        window=0.5 * factor,
        sample_rate=6000 / factor,
        band=(200.3 / factor, 800.3 / factor),
    )
    np.testing.assert_allclose(estimates(scaled), estimates(vessel), atol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.floats(-np.pi, np.pi), st.floats(0.01, 100))
def test_noisy_data_turned_and_scaled_give_turned_estimates(turn, gain):
    heard = record(short_vessel(snr_db=0.0), rng(51))
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    before = direction_of_arrival(averaged_intensity(heard.pressure, heard.velocity, 3000))
    turned = gain * heard.velocity @ rotation.T
    after = direction_of_arrival(averaged_intensity(gain * heard.pressure, turned, 3000))
    np.testing.assert_allclose(angle_difference(after[0], before[0] + turn), 0, atol=1e-9)
    np.testing.assert_allclose(after[1], before[1], atol=1e-9)


# --- recordings from files ---


CHANNELS = rng(60).uniform(-0.5, 0.5, (2000, 4))


@pytest.mark.parametrize("kind", [np.int16, np.int32, np.float32])
@pytest.mark.parametrize(
    ("order", "encode"),
    [
        ("pxyz", lambda p, x, y, z: (p, x, y, z)),
        ("fuma", lambda p, x, y, z: (p / np.sqrt(2), x, y, z)),
        ("sn3d", lambda p, x, y, z: (p, y, z, x)),
    ],
)
def test_a_recording_comes_back_from_its_file(tmp_path, kind, order, encode):
    samples = np.stack(encode(*CHANNELS.T), axis=-1)
    scale = 1.0 if kind is np.float32 else np.iinfo(kind).max + 1.0
    wavfile.write(tmp_path / "sea.wav", 8000, (samples * scale).astype(kind))
    heard = load_recording(tmp_path / "sea.wav", order)
    assert heard.sample_rate == 8000 and heard.time[1] == 1 / 8000
    np.testing.assert_allclose(heard.pressure, CHANNELS[:, 0], atol=1e-4)
    np.testing.assert_allclose(heard.velocity, CHANNELS[:, 1:], atol=1e-4)


def test_gains_calibrate_the_channels_of_the_file(tmp_path):
    wavfile.write(tmp_path / "sea.wav", 8000, CHANNELS.astype(np.float32))
    heard = load_recording(tmp_path / "sea.wav", gains=(1, 2, -3, 4))
    np.testing.assert_allclose(heard.velocity, CHANNELS[:, 1:] * [2, -3, 4], rtol=1e-5)


def test_a_recorded_vessel_is_found_from_its_file(tmp_path):
    vessel = PassingVessel()
    heard = record(vessel, rng(61), (18.0, 21.0))
    channels = np.column_stack([heard.pressure, heard.velocity]) / 8
    wavfile.write(tmp_path / "vessel.wav", 6000, channels.astype(np.float32))
    loaded = load_recording(tmp_path / "vessel.wav")
    azimuth, _ = direction_of_arrival(averaged_intensity(loaded.pressure, loaded.velocity, 3000))
    truth = geometry(vessel, window_centres(vessel)[36:42]).azimuth
    np.testing.assert_allclose(azimuth, truth, atol=np.radians(4 * 0.6))


@pytest.mark.parametrize("channels", [1, 2, 3, 5])
def test_a_file_without_four_channels_is_refused(tmp_path, channels):
    wavfile.write(tmp_path / "sea.wav", 8000, np.zeros((100, channels), dtype=np.int16).squeeze())
    with pytest.raises(ValueError, match=f"4 channels.*sea.wav has {channels}"):
        load_recording(tmp_path / "sea.wav")


@pytest.mark.parametrize("content", [b"", b"time,x,y\n", b"RIFF\x00\x00", b"RIFF\x04\0\0\0WAVE"])
def test_a_file_that_is_not_a_recording_is_refused(tmp_path, content):
    (tmp_path / "notes.wav").write_bytes(content)
    with pytest.raises(ValueError, match="notes.wav"):
        load_recording(tmp_path / "notes.wav")


def test_samples_that_are_not_finite_are_refused(tmp_path):
    wavfile.write(tmp_path / "sea.wav", 8000, np.full((100, 4), np.nan, dtype=np.float32))
    with pytest.raises(ValueError, match="sea.wav must be finite"):
        load_recording(tmp_path / "sea.wav")


def test_an_unknown_order_is_refused(tmp_path):
    with pytest.raises(ValueError, match="order must be one of 'pxyz', 'fuma', 'sn3d', but 'zyxp'"):
        load_recording(tmp_path / "sea.wav", "zyxp")


# --- bad input ---


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"sensor_depth": 0.0}, "sensor_depth must be above 0, but 0"),
        ({"sensor_depth": -5.0}, "sensor_depth must be above 0, but -5"),
        ({"sound_speed": 0.0}, "sound_speed must be above 0, but 0"),
        ({"speed": -1.0}, "speed must lie from 0 to below 1500 m/s, but -1"),
        ({"speed": 1500.0}, "speed must lie from 0 to below 1500 m/s, but 1500"),
        ({"window": 61.0}, "window must lie between .* the duration, 60 s, but 61"),
        ({"window": 1e-5}, "window must lie between one sample"),
        ({"window": 0.0}, "window must be above 0, but 0"),
        ({"duration": -1.0}, "duration must be above 0, but -1"),
        ({"sample_rate": 0.0}, "sample_rate must be above 0, but 0"),
        ({"band": (200.0, 3001.0)}, r"band must be .* within 0 to 3000, but \(200, 3001\)"),
        ({"band": (800.0, 200.0)}, r"band must be .*\(800, 200\)"),
        ({"band": (-1.0, 200.0)}, "band must be"),
        ({"band": (200.0,)}, r"band must have shape \(..., 2\), but \(1,\)"),
        ({"snr_db": np.nan}, "snr_db must be finite, but nan"),
        ({"heading": np.inf}, "heading must be finite, but inf"),
        ({"start": (np.nan, 0.0)}, "start must be finite, but nan"),
        ({"start": (1.0, 2.0, 3.0)}, r"start must have shape \(..., 2\), but \(3,\)"),
        ({"velocity_noise_ratio": 0.0}, "velocity_noise_ratio must be above 0, but 0"),
        ({"sensor_depth": np.array([1.0, 2.0])}, r"sensor_depth must be one number, but .* \(2,\)"),
        ({"sensor_depth": "deep"}, "sensor_depth must be a number .*'deep'"),
        ({"track": "north"}, "track must be a labsim.motion.Track, but 'north'"),
        ({"track": waypoint_track([0, 30], [(0, 0), (9, 9)])}, "track must cover .* 60 s, .* 0 to 30"),
    ],
)
def test_a_vessel_that_cannot_be_is_refused_in_words(fields, message):
    with pytest.raises(ValueError, match=message):
        PassingVessel(**fields)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: geometry(PassingVessel(), np.nan), "time must be finite, but nan"),
        (lambda: record(PassingVessel(), rng(), (5.0, 4.0)), r"interval must be .*\(5, 4\)"),
        (lambda: record(PassingVessel(), rng(), (50.0, 61.0)), r"interval must be .*\(50, 61\)"),
        (lambda: averaged_intensity(np.zeros(9), np.zeros((9, 2)), 3), r"velocity must .* \(..., 9, 3\)"),
        (lambda: averaged_intensity(np.zeros(9), np.zeros((8, 3)), 3), r"velocity must .* \(..., 9, 3\)"),
        (lambda: averaged_intensity(np.zeros(9), np.zeros((9, 3)), 10), "window .* from 1 to 9, but 10"),
        (lambda: averaged_intensity(np.zeros(9), np.zeros((9, 3)), 0), "window .* from 1 to 9, but 0"),
        (lambda: averaged_intensity(np.zeros(9), np.zeros((9, 3)), 2.5), "window .* whole .*, but 2.5"),
        (lambda: direction_of_arrival(np.zeros((5, 2))), r"intensity must have shape .*\(5, 2\)"),
        (lambda: maximum_likelihood_direction(np.eye(3)), r"covariance must have shape \(..., 4, 4\)"),
        (lambda: maximum_likelihood_direction(np.eye(4), 0.0), "velocity_noise_ratio must be above 0"),
        (lambda: sample_covariance(PassingVessel(band=(200, 210)), rng(), 5), "2 B T / blocks .* above 3"),
        (
            lambda: sample_intensity(PassingVessel(), rng(), 5, blocks=0),
            "blocks must be a whole .*, but 0",
        ),
        (lambda: static_source(0.0, np.pi / 2), "angle_from_vertical must lie from 0 to below pi/2"),
        (lambda: intensity_error(0.0, 300), "snr must be above 0, but 0"),
        (lambda: cramer_rao_bound(1.0, -3), "time_bandwidth must be above 0, but -3"),
        (lambda: best_window(0.0, 1.0), "error_in_one_second must be above 0"),
    ],
)
def test_arguments_that_cannot_be_are_refused_in_words(call, message):
    with pytest.raises(ValueError, match=message):
        call()
