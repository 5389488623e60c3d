"""Bistatic geometry, bounds and detections against independent computation, theory and Monte Carlo."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsim import bistatic as bs

SCENE = bs.BistaticScenario()
GEOMETRY = SCENE.geometry

# away from the baseline and from both ends
places = st.tuples(st.floats(-8_000, 8_000), st.floats(300, 9_000)).map(np.array)
velocities = st.tuples(st.floats(-10, 10), st.floats(-10, 10)).map(np.array)


def turned(vector, angle):
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.asarray(vector) @ np.array([[cosine, sine], [-sine, cosine]])


def test_location_undoes_bearing_and_delay():
    rng = np.random.default_rng(1)
    for receiver, source in (((0.0, 0.0), (4_000.0, 0.0)), ((500.0, -300.0), (3_000.0, 2_000.0))):
        position = rng.uniform(-9_000, 9_000, (100_000, 2))
        bearing, delay = bs.bearing_and_delay(position, receiver, source, 1_500.0)
        apart = delay * 1_500.0 > np.hypot(*np.subtract(source, receiver)) + 0.01
        found = bs.locate(bearing[apart], delay[apart], receiver, source, 1_500.0)
        assert np.mean(apart) > 0.999
        assert np.abs(found - position[apart]).max() <= 1e-6


@given(places, st.floats(-3, 3))
def test_turning_everything_turns_the_bearing_and_keeps_the_delay(position, angle):
    bearing, delay = bs.bearing_and_delay(position, *GEOMETRY)
    source = turned(SCENE.source, angle)
    new_bearing, new_delay = bs.bearing_and_delay(turned(position, angle), (0.0, 0.0), source, 1_500.0)
    assert np.exp(1j * (new_bearing - bearing)) == pytest.approx(np.exp(1j * angle), abs=1e-9)
    assert new_delay == pytest.approx(delay, rel=1e-12)


@given(places, velocities)
def test_mirroring_changes_the_sign_of_the_bearing_alone(position, velocity):
    state = np.array([position[0], velocity[0], position[1], velocity[1]])
    values, _ = bs.observe(state, 3_000.0, *GEOMETRY)
    mirrored, _ = bs.observe(state * [1, 1, -1, -1], 3_000.0, *GEOMETRY)
    np.testing.assert_allclose(mirrored, values * [-1, 1, 1], rtol=1e-9, atol=1e-9)


@given(places, st.floats(0.1, 10))
def test_delay_scales_with_length(position, scale):
    one = bs.bearing_and_delay(position, *GEOMETRY)[1]
    other = bs.bearing_and_delay(scale * position, (0.0, 0.0), (scale * 4_000.0, 0.0), 1_500.0)[1]
    assert other == pytest.approx(scale * one, rel=1e-12)


@given(places, velocities)
def test_doppler_is_how_the_travel_time_of_successive_sounds_changes(position, velocity):
    # a sound scattered at time s left at e(s) and arrived at r(s); the ratio is de/dr, here over 20 ms
    def left_and_arrived(time):
        to_receiver, to_source = (np.linalg.norm(position + velocity * time - end) for end in GEOMETRY[:2])
        return time - to_source / 1_500.0, time + to_receiver / 1_500.0

    (left_0, arrived_0), (left_1, arrived_1) = left_and_arrived(-0.01), left_and_arrived(0.01)
    ratio = (left_1 - left_0) / (arrived_1 - arrived_0)
    assert bs.doppler_ratio(position, velocity, *GEOMETRY) == pytest.approx(ratio, abs=1e-9)


def test_an_observer_sees_bearing_delay_and_doppler_in_radians_seconds_and_hertz():
    # abeam of the source: legs of 5 and 3 km; towards the source at 15 m/s, 15 * 0.6 of it to the receiver
    values, _ = bs.observer(SCENE)(np.array([4_000.0, 0.0, 3_000.0, -15.0]))
    expected = [np.arctan2(3, 4), 8_000 / 1_500, 3_000 * (1.01 / 0.994 - 1)]
    np.testing.assert_allclose(values, expected, rtol=1e-12)


@given(places, velocities)
def test_derivatives_of_the_measurement_agree_with_differences(position, velocity):
    state = np.array([position[0], velocity[0], position[1], velocity[1]])
    _, jacobian = bs.observe(state, 3_000.0, *GEOMETRY)
    for axis, pace in enumerate((0.1, 0.01, 0.1, 0.01)):
        shift = pace * np.eye(4)[axis]
        up, down = (bs.observe(state + sign * shift, 3_000.0, *GEOMETRY)[0] for sign in (1, -1))
        scale = np.maximum(np.abs(jacobian[:, axis]), [1 / 10_000, 1 / 1_500, 1e-3])
        assert np.all(np.abs((up - down) / (2 * pace) - jacobian[:, axis]) <= 1e-6 * scale + 1e-9)


@given(st.tuples(st.floats(-8_000, 8_000), st.floats(1_000, 9_000)).map(np.array))
def test_derivatives_of_the_location_agree_with_differences(position):
    bearing, delay = bs.bearing_and_delay(position, *GEOMETRY)
    jacobian = bs.location_jacobian(bearing, delay, *GEOMETRY)
    pace = 1e-5
    by_bearing = bs.locate(bearing + pace, delay, *GEOMETRY) - bs.locate(bearing - pace, delay, *GEOMETRY)
    by_delay = bs.locate(bearing, delay + pace, *GEOMETRY) - bs.locate(bearing, delay - pace, *GEOMETRY)
    numeric = np.stack([by_bearing, by_delay], -1) / (2 * pace)
    assert np.abs(numeric - jacobian).max() <= 1e-6 * np.abs(jacobian).max()


def test_the_two_jacobians_are_inverse_to_each_other():
    rng = np.random.default_rng(3)
    position = np.stack([rng.uniform(-8e3, 8e3, 10_000), rng.uniform(300, 9e3, 10_000)], -1)
    state = np.zeros((10_000, 4))
    state[:, 0::2] = position
    _, forward = bs.observe(state, 3_000.0, *GEOMETRY)
    backward = bs.location_jacobian(*bs.bearing_and_delay(position, *GEOMETRY), *GEOMETRY)
    product = backward @ forward[:, :2, 0::2]
    np.testing.assert_allclose(product, np.broadcast_to(np.eye(2), product.shape), atol=1e-9)


@pytest.mark.parametrize("inclination_deg, error", [(5, -176), (15, -545), (30, -1_132)])
def test_reading_one_angle_for_the_other_moves_the_target_by_hundreds_of_metres(inclination_deg, error):
    angle = np.radians(inclination_deg)
    source = (4_000 * np.cos(angle), 4_000 * np.sin(angle))
    position = np.array([1_000.0, 6_000.0])
    bearing, delay = bs.bearing_and_delay(position, (0.0, 0.0), source, 1_500.0)
    literal = bs.ellipse_range(bearing, delay, *GEOMETRY)
    assert literal - np.hypot(*position) == pytest.approx(error, abs=1)


def nees(position, bearing_sigma_deg, delay_sigma, draws=20_000, seed=5):
    """Normalised squared errors of location, and the share of draws that have a location at all."""
    rng = np.random.default_rng(seed)
    bearing, delay = bs.bearing_and_delay(np.asarray(position, dtype=float), *GEOMETRY)
    bearing = bearing + np.radians(bearing_sigma_deg) * rng.standard_normal(draws)
    delay = delay + delay_sigma * rng.standard_normal(draws)
    possible = delay * 1_500.0 > 4_000.0
    bearing, delay = bearing[possible], delay[possible]
    jacobian = bs.location_jacobian(bearing, delay, *GEOMETRY)
    covariance = bs.location_covariance(jacobian, np.radians(bearing_sigma_deg) ** 2, delay_sigma**2)
    error = bs.locate(bearing, delay, *GEOMETRY) - position
    return np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error), possible.mean()


@pytest.mark.parametrize(
    "position, bearing_sigma_deg, delay_sigma",
    [(place, sigma_deg, 0.01) for place in ((0, 8_000), (3_000, 2_500)) for sigma_deg in (0.3, 1.0)],
)
def test_the_linearised_covariance_is_consistent_while_the_ellipse_is_nearly_straight(
    position, bearing_sigma_deg, delay_sigma
):
    # 20 000 draws: standard error of the mean 0.014, of the cover 0.0015; 4 % is the curvature allowed
    squares, possible = nees(position, bearing_sigma_deg, delay_sigma)
    assert possible == 1
    assert squares.mean() == pytest.approx(2, abs=0.08 + 3 * 0.014)
    assert np.mean(squares < 5.991) == pytest.approx(0.95, abs=0.015)


def test_the_linearised_covariance_lies_with_coarse_bearings_and_near_the_baseline():
    coarse, _ = nees((0, 8_000), 3.0, 0.01)
    assert coarse.mean() > 6 and np.mean(coarse < 5.991) < 0.8
    near, possible = nees((2_000, 200), 0.3, 0.01)
    assert 0.89 < possible < 0.93
    assert np.mean(near < 5.991) < 0.88 and near.mean() > 50


def test_the_complex_bearing_bound_is_what_the_best_estimator_reaches():
    # 4 000 snapshots of 16 elements at 10 dB and 60 degrees: standard error of the RMSE 1.1 %
    rng = np.random.default_rng(6)
    elements, bearing, snr, trials = 16, np.radians(60), 10.0, 4_000
    phase = np.pi * np.cos(bearing) * np.arange(elements)
    noise = rng.standard_normal((2, trials, elements)) / np.sqrt(2 * snr)
    snapshots = np.exp(1j * phase) + noise[0] + 1j * noise[1]
    size = 1 << 11
    peak = np.argmax(np.abs(np.fft.fft(snapshots, size)), axis=1) * 2 / size
    error = np.arccos((peak + 1) % 2 - 1) - bearing
    measured = np.sqrt(np.mean(error**2))
    complex_data, real_data = (bs.bearing_bound(snr, bearing, 3_000, 16, 0.25, 1_500, f) for f in (6, 12))
    assert measured == pytest.approx(np.sqrt(complex_data), rel=0.045)
    assert measured < 0.8 * np.sqrt(real_data)


def test_the_bearing_bound_is_reached_with_real_samples_too():
    # least squares over sine and cosine, 2 000 snapshots at 15 dB: standard error of the RMSE 1.6 %
    rng = np.random.default_rng(15)
    places, bearing, snr = np.arange(16), np.radians(60), 10**1.5
    phase = rng.uniform(0, 2 * np.pi, (2_000, 1))
    noise = rng.standard_normal((2_000, 16)) / np.sqrt(2 * snr)
    heard = np.cos(np.pi * np.cos(bearing) * places + phase) + noise
    tried = np.radians(np.linspace(57, 63, 601))
    angle = np.pi * np.cos(tried)[:, None] * places
    basis = np.linalg.qr(np.stack([np.cos(angle), np.sin(angle)], -1))[0]
    power = np.sum(np.einsum("tn,bnk->tbk", heard, basis) ** 2, -1)
    measured = np.sqrt(np.mean((tried[np.argmax(power, axis=1)] - bearing) ** 2))
    bound = bs.bearing_bound(snr, bearing, 3_000.0, 16, 0.25, 1_500.0)
    assert measured == pytest.approx(np.sqrt(bound), rel=0.065)


def test_the_printed_delay_bound_has_the_size_we_state():
    assert np.sqrt(bs.printed_delay_bound(10.0, 3_000.0, 16)) == pytest.approx(8.0e-6, rel=0.01)
    assert np.sqrt(bs.delay_bound(10.0, 100.0)) > 100 * 8e-6


def test_the_pulse_bound_is_reached_by_a_matched_filter():
    # flat spectrum over B: 3 000 pulses at 20 dB, standard error of the RMSE 1.3 %
    rng = np.random.default_rng(7)
    bandwidth, snr, bins = 100.0, 100.0, 64
    frequency = (np.arange(bins) - (bins - 1) / 2) * bandwidth / bins
    noise = rng.standard_normal((2, 3_000, bins)) * np.sqrt(bins / 2 / snr)
    # the phase of the carrier is known, as in the bound: maximise the real part near the true delay
    spectrum = 1 + noise[0] + 1j * noise[1]
    delay = np.linspace(-4e-3, 4e-3, 1_601)
    likelihood = np.real(spectrum @ np.exp(2j * np.pi * frequency[:, None] * delay))
    error = delay[np.argmax(likelihood, axis=1)]
    assert np.sqrt(np.mean(error**2)) == pytest.approx(np.sqrt(bs.delay_bound(snr, bandwidth)), rel=0.06)


def test_the_frequency_bound_is_the_papers_for_many_samples():
    samples, rate, snr = 4_000, 2_000.0, 3.0
    per_sample = 12 / ((2 * np.pi) ** 2 * snr / samples * samples * (samples**2 - 1))
    assert bs.doppler_bound(snr, samples / rate) == pytest.approx(per_sample * rate**2, rel=1e-6)


def test_a_target_is_loud_broadside_and_faint_end_on():
    position = np.array([2_000.0, 3_000.0])
    strength = [
        bs.target_strength(position, np.array(velocity), *GEOMETRY[:2], (5.0, 20.0))
        for velocity in ((2.0, 0.0), (0.0, -2.0), (2.0, 2.0))
    ]
    np.testing.assert_allclose(strength, [20.0, 5.0, 12.5], atol=1e-9)


def test_snr_follows_the_sonar_equation():
    # by hand: legs of 5 and 3 km lose 73.98 + 1.0 and 69.54 + 0.6 dB; 215 - 60 - 145.12 = 9.88 dB, and the
    # strength is 5 dB along the bisector, which points down (1, 2), and 20 dB across it
    open_scene = replace(SCENE, snr_limits_db=(-200.0, 200.0))
    for velocity, expected in (((1.0, 2.0), 14.88), ((2.0, -1.0), 29.88)):
        level = bs.echo_snr_db(open_scene, np.array([4_000.0, 3_000.0]), np.array(velocity))
        assert level == pytest.approx(expected, abs=0.005)


def test_the_scene_spans_faint_to_loud():
    states = bs.true_states(SCENE)
    alive = np.isfinite(states[..., 0])
    level = bs.echo_snr_db(SCENE, states[alive][:, 0::2], states[alive][:, 1::2])
    assert level.min() == 0 and level.max() == 25
    np.testing.assert_array_equal(alive.sum(axis=1)[[0, 20, 40, 70, 90]], [2, 3, 4, 3, 2])


def test_detections_have_the_right_number_origin_and_spread():
    # 200 runs, seed 8: standard errors 0.03 (clutter), 0.001 (detection), 1 % (spread)
    detections = bs.simulate_detections(np.random.default_rng(8), SCENE, 200)
    clutter = np.count_nonzero(detections.origin == bs.CLUTTER, axis=-1)
    assert clutter.mean() == pytest.approx(20, abs=4 * np.sqrt(20 / 20_000))
    assert clutter.var() == pytest.approx(20, rel=0.05)
    states = bs.true_states(SCENE)
    alive = np.isfinite(states[..., 0])
    heard = detections.origin[..., :4] >= 0
    assert heard[:, alive].mean() == pytest.approx(0.9, abs=4 * 0.3 / np.sqrt(200 * alive.sum()))
    assert not heard[:, ~alive].any()


def test_each_detection_errs_as_its_own_snr_says():
    # 100 runs, 27 000 detections: standard error of a spread 0.4 %
    detections = bs.simulate_detections(np.random.default_rng(13), SCENE, 100)
    states = bs.true_states(SCENE)
    alive = np.isfinite(states[..., 0])
    truth, snr = np.ones((*alive.shape, 3)), np.ones(alive.shape)
    truth[alive] = bs.observe(states[alive], 3_000.0, *GEOMETRY)[0]
    snr[alive] = 10 ** (bs.echo_snr_db(SCENE, states[alive][:, 0::2], states[alive][:, 1::2]) / 10)
    heard = detections.origin[..., :4] >= 0
    measured = np.stack([detections.bearing, detections.delay, detections.doppler], -1)[..., :4, :]
    spread = np.sqrt(bs.measurement_variance(SCENE, truth[..., 0], snr))
    score = ((measured - truth) / spread)[heard]
    assert np.all(np.abs(score.std(axis=0) - 1) < 4 / np.sqrt(2 * len(score)))
    assert np.all(np.abs(score.mean(axis=0)) < 4 / np.sqrt(len(score)))
    np.testing.assert_allclose(detections.snr[..., :4][heard], np.broadcast_to(snr, heard.shape)[heard])


def test_loud_echoes_keep_the_floors_and_faint_ones_add_the_bounds():
    floors = [np.radians(0.3) ** 2, 0.010**2, 0.3**2]
    np.testing.assert_allclose(bs.measurement_variance(SCENE, 1.0, 1e12), floors, rtol=1e-6)
    # by hand, SNR 2, broadside: 12 / (4 pi^2 2 16 255 / 4), 3 / (2 pi^2 100^2 2) and 12 / (4 pi^2 2)
    bounds = [1.4900e-4, 7.5991e-6, 0.151982]
    np.testing.assert_allclose(
        bs.measurement_variance(SCENE, np.pi / 2, 2.0), np.add(floors, bounds), rtol=1e-4
    )


def test_filters_are_told_the_covariance_of_each_detection():
    # 4 000 draws at each of two SNRs: standard error of a variance 2.2 %, of the mean NEES 0.032
    rng = np.random.default_rng(14)
    for place, snr in (((1_000.0, 4_000.0), 10.0), ((-3_000.0, 3_000.0), 200.0)):
        bearing, delay = bs.bearing_and_delay(np.array(place), *GEOMETRY)
        spread = np.sqrt(bs.measurement_variance(SCENE, bearing, snr))
        values = [bearing, delay, 0.0] + spread * rng.standard_normal((4_000, 3))
        scan = bs.Detections(*values.T, np.full(4_000, snr), np.zeros(4_000, dtype=int))
        raw, covariance, _ = bs.native_measurements(SCENE, scan)
        np.testing.assert_allclose(np.var(raw, axis=0), np.diag(covariance.mean(axis=0)), rtol=0.1)
        found, covariance, _ = bs.converted_measurements(SCENE, scan)
        error = found - place
        squares = np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariance), error)
        assert squares.mean() == pytest.approx(2, abs=5 * 0.032)


def test_targets_start_at_their_birth_and_move_on_straight():
    states = bs.true_states(SCENE)
    for number, (birth, death, x, vx, y, vy) in enumerate(SCENE.targets):
        np.testing.assert_allclose(states[birth, number], [x, vx, y, vy])
        later = 20.0 * (death - 1 - birth)
        np.testing.assert_allclose(states[death - 1, number], [x + vx * later, vx, y + vy * later, vy])
        assert np.isnan(states[:birth, number]).all() and np.isnan(states[death:, number]).all()


def test_all_scans_are_the_scans_one_after_the_other():
    detections = bs.simulate_detections(np.random.default_rng(12), SCENE)
    row, splits = detections.all_scans()
    for number, bearing in enumerate(np.split(row.bearing, splits)):
        np.testing.assert_array_equal(bearing, detections.scan(number).bearing)


def test_clutter_is_uniform_in_measurement_space_and_its_density_in_the_plane_says_so():
    scene = replace(SCENE, clutter_rate=4_000.0, scans=5, targets=())
    scan = bs.simulate_detections(np.random.default_rng(9), scene).scan(0)
    assert np.all((scan.delay > 3.2) & (scan.delay < 14) & (np.abs(scan.doppler) < 40))
    loudness_db = 10 * np.log10(scan.snr)  # standard error of its mean 0.09 dB
    assert loudness_db.min() > 0 and loudness_db.max() < 20
    assert loudness_db.mean() == pytest.approx(10, abs=0.4)
    value, _, density = bs.converted_measurements(scene, scan)
    inside = np.hypot(*(value - [2_000, 5_000]).T) < 1_500
    expected = density[inside].mean() * np.pi * 1_500**2
    assert inside.sum() == pytest.approx(expected, abs=5 * np.sqrt(expected))
    assert bs.clutter_density(scene, doppler=True) * 80 == pytest.approx(bs.clutter_density(scene))


def test_the_region_has_the_area_that_its_clutter_fills():
    # 80 000 points, each standing for an area |det J|: standard error 0.3 %
    scene = replace(SCENE, clutter_rate=80_000.0, scans=1, targets=())
    scan = bs.simulate_detections(np.random.default_rng(11), scene).scan(0)
    jacobian = bs.location_jacobian(scan.bearing, scan.delay, *GEOMETRY)
    volume = np.radians(160) * 10.8
    assert bs.region_area(SCENE) == pytest.approx(np.abs(np.linalg.det(jacobian)).mean() * volume, rel=0.01)
    assert bs.region_area(SCENE) == pytest.approx(146.7e6, rel=1e-3)


def test_empty_scans_give_empty_measurements():
    quiet = replace(SCENE, clutter_rate=0.0, detection_probability=0.0)
    scan = bs.simulate_detections(np.random.default_rng(1), quiet).scan(3)
    assert [len(part) for part in bs.converted_measurements(quiet, scan)] == [0, 0, 0]
    assert bs.native_measurements(quiet, scan)[1].shape == (0, 3, 3)
    nobody = replace(SCENE, targets=(), clutter_rate=0.0)
    assert bs.simulate_detections(np.random.default_rng(1), nobody).bearing.shape == (100, 0)


def test_places_without_an_answer_are_refused_in_words():
    with pytest.raises(ValueError, match="delay must be longer than the direct path's, 2.66667 s"):
        bs.locate(0.5, [5.0, 2.0], *GEOMETRY)
    on_baseline = bs.bearing_and_delay([2_000.0, 0.0], *GEOMETRY)
    with pytest.raises(ValueError, match="on the baseline no position follows"):
        bs.location_jacobian(*on_baseline, *GEOMETRY)
    with pytest.raises(ValueError, match="position must not be at the receiver"):
        bs.bearing_and_delay([0.0, 0.0], *GEOMETRY)
    with pytest.raises(ValueError, match="position must not be at the source"):
        bs.doppler_ratio([4_000.0, 0.0], [1.0, 0.0], *GEOMETRY)
    with pytest.raises(ValueError, match="velocity must be slower than sound, 1500 m/s, but 2000 was given"):
        bs.doppler_ratio([1_000.0, 1_000.0], [2_000.0, 0.0], *GEOMETRY)
    with pytest.raises(ValueError, match="velocity must be slower than sound"):
        bs.observe([1_000.0, 2_000.0, 1_000.0, 0.0], 3_000.0, *GEOMETRY)
    with pytest.raises(ValueError, match="source and receiver must be apart"):
        bs.locate(0.5, 5.0, (0.0, 0.0), (0.0, 0.0), 1_500.0)
    with pytest.raises(ValueError, match="snr must be above 0"):
        bs.bearing_bound(0.0, 1.0, 3_000.0, 16, 0.25, 1_500.0)


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"detection_probability": 1.1}, "detection_probability must lie between 0 and 1"),
        ({"clutter_rate": -1.0}, "clutter_rate must not be negative"),
        ({"delay_region": (2.0, 14.0)}, "delay_region must be longer than the direct path's"),
        ({"bearing_region_deg": (170.0, 10.0)}, "bearing_region_deg must be"),
        ({"sound_speed": 0.0}, "sound_speed must be above 0"),
        ({"elements": 1}, "elements must be a whole number from 2 up"),
        ({"elements": 2.5}, "elements must be a whole number"),
        ({"scans": 2.5}, "scans must be a whole number"),
        ({"period": (1.0, 2.0)}, "period must be one number"),
        ({"receiver": (np.nan, 0.0)}, "receiver must be finite"),
        ({"source": (1.0, 0.0, 0.0)}, "source must have shape"),
        ({"source": ((1.0, 0.0),)}, "source must be two numbers"),
        (
            {"targets": ((0, 9, 0.0, 1_200.0, 5_000.0, 900.0),)},
            "velocity of targets must be slower than sound",
        ),
    ],
)
def test_scenes_that_cannot_be_are_refused_in_words(changes, words):
    with pytest.raises(ValueError, match=words):
        replace(SCENE, **changes)
