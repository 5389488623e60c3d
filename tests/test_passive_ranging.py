from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsim import passive_ranging as pr
from labsim.passive_ranging import Triplet

BEARINGS = np.radians([0.0, 30.0, 60.0])
RANGES = np.array([1e3, 2e3, 5e3, 10e3])
ARRAY = Triplet()

angles = st.floats(-1.0, 1.0)
ranges = st.floats(800.0, 20e3)


def measured_range(triplet, assumed, target_range, bearing):
    return pr.estimated_range(triplet, assumed, pr.target_at(target_range, bearing))


def test_delays_agree_with_distances_worked_out_by_hand():
    tau12, tau23 = pr.arrival_delays(Triplet(spacing=30.0), [40.0, 0.0, 0.0])
    assert tau12 == pytest.approx((70 - 40) / 1500)
    assert tau23 == pytest.approx((40 - 10) / 1500)


def test_the_bend_over_the_arm_is_25_cm_at_5_km():
    tau, eps = pr.mean_and_difference(*pr.arrival_delays(ARRAY, pr.target_at(5e3, 0.0)))
    assert tau == pytest.approx(0.0, abs=1e-15)
    assert 1500 * eps / 2 == pytest.approx(0.25, rel=1e-4)


@given(angles, st.floats(-0.4, 0.4), st.floats(-0.4, 0.4), st.floats(-0.3, 0.3))
def test_rotating_the_world_with_the_array_changes_no_delay(bearing, pitch, roll, turn):
    displaced = Triplet(displacement=(0.3, -0.2, 0.1), pitch=pitch, roll=roll)
    target = pr.target_at(3e3, bearing, turn)
    in_body_axes = pr.array_axes(displaced) @ target
    level = replace(displaced, pitch=0.0, roll=0.0)
    turned = pr.arrival_delays(level, in_body_axes)
    np.testing.assert_allclose(pr.arrival_delays(displaced, target), turned, atol=1e-14)


@given(angles, ranges)
def test_mirroring_swaps_the_delays(bearing, target_range):
    tau12, tau23 = pr.arrival_delays(ARRAY, pr.target_at(target_range, bearing))
    mirrored = pr.arrival_delays(ARRAY, pr.target_at(target_range, -bearing))
    np.testing.assert_allclose(mirrored, (-tau23, -tau12), atol=1e-14)


@given(angles, ranges, st.floats(0.1, 10.0))
def test_scaling_the_scene_scales_the_estimated_range(bearing, target_range, scale):
    small = measured_range(ARRAY, ARRAY, target_range, bearing)
    large_array = Triplet(spacing=50.0 * scale)
    large = measured_range(large_array, large_array, target_range * scale, bearing)
    assert large == pytest.approx(scale * small, rel=1e-6)


@given(st.floats(-0.5, 0.5), st.floats(-0.5, 0.5))
def test_array_axes_are_a_rotation(pitch, roll):
    axes = pr.array_axes(Triplet(pitch=pitch, roll=roll))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1.0)


@given(angles, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_displacement_towards_the_target_is_the_papers_eq_2_3(bearing, pitch, roll):
    eta, zeta, xi = 0.1, -0.2, 0.3
    sin, cos = np.sin, np.cos
    written_out = (
        cos(pitch) * sin(bearing) * eta
        + (sin(roll) * sin(pitch) * sin(bearing) + cos(roll) * cos(bearing)) * zeta
        + (sin(roll) * cos(bearing) - cos(roll) * sin(pitch) * sin(bearing)) * xi
    )
    triplet = Triplet(displacement=(eta, zeta, xi), pitch=pitch, roll=roll)
    assert pr.displacement_toward(triplet, bearing) == pytest.approx(written_out, abs=1e-14)


@pytest.mark.parametrize("spacing", [20.0, 50.0])
@pytest.mark.parametrize("pitch_deg", [-10.0, 0.0, 5.0, 10.0])
def test_range_without_displacement_is_right_to_a_hundredth_of_a_percent(spacing, pitch_deg):
    triplet = Triplet(spacing=spacing, pitch=np.radians(pitch_deg), roll=np.radians(4.0))
    bearing = np.radians(np.arange(-60, 61, 5.0))
    estimated = measured_range(triplet, triplet, 5e3, bearing)
    np.testing.assert_allclose(estimated, 5e3, rtol=1e-4)


def test_range_with_a_known_random_displacement_is_right_to_a_tenth_of_a_percent():
    rng = np.random.default_rng(31)
    offset = rng.standard_normal((400, 3))
    offset *= 0.1 / np.linalg.norm(offset, axis=-1, keepdims=True)
    for pitch, roll in np.radians([(0.0, 0.0), (10.0, 5.0), (-7.0, -10.0)]):
        triplet = Triplet(displacement=offset, pitch=pitch, roll=roll)
        estimated = measured_range(triplet, triplet, 5e3, rng.uniform(-1.05, 1.05, 400))
        assert np.max(np.abs(estimated / 5e3 - 1)) < 1e-3
        assert np.median(np.abs(estimated / 5e3 - 1)) < 1e-4


def test_printed_sign_ruins_the_range_of_a_known_displacement():
    rng = np.random.default_rng(32)
    offset = rng.standard_normal((2000, 3))
    offset *= 0.1 / np.linalg.norm(offset, axis=-1, keepdims=True)
    triplet = Triplet(displacement=offset)
    target = pr.target_at(5e3, rng.uniform(-1.05, 1.05, 2000))
    delays = pr.mean_and_difference(*pr.arrival_delays(triplet, target))
    printed = pr.range_from_delays_as_printed(triplet, *delays)
    error = np.abs(printed / 5e3 - 1)
    assert np.median(np.where(np.isnan(error), np.inf, error)) > 0.3


@pytest.mark.parametrize("pitch_deg, percent", [(5.0, (-0.76, -1.01, -2.97)), (10.0, (-3.0, -4.0, -11.1))])
def test_printed_numerator_loses_the_square_of_the_pitch(pitch_deg, percent):
    triplet = Triplet(pitch=np.radians(pitch_deg))
    delays = pr.mean_and_difference(*pr.arrival_delays(triplet, pr.target_at(5e3, BEARINGS)))
    error = 100 * (pr.range_from_delays_as_printed(triplet, *delays) / 5e3 - 1)
    np.testing.assert_allclose(error, percent, atol=0.06)


def test_printed_and_mended_forms_agree_for_a_level_undisplaced_array():
    delays = pr.mean_and_difference(*pr.arrival_delays(ARRAY, pr.target_at(5e3, BEARINGS)))
    np.testing.assert_allclose(
        pr.range_from_delays(ARRAY, *delays), pr.range_from_delays_as_printed(ARRAY, *delays), rtol=1e-12
    )


def test_table_1_for_one_centimetre_broadside():
    table = pr.ranging_error_table(ARRAY, RANGES, BEARINGS, [0.01])
    np.testing.assert_allclose(100 * table.exact[:, 0, 1, 0], [-0.73, -1.56, -3.84, -7.41], atol=0.006)
    np.testing.assert_allclose(100 * table.first_order[:, 0, 1, 0], [-0.80, -1.60, -4.00, -8.00], atol=0.006)


def test_table_1_for_ten_centimetres_along_the_line():
    table = pr.ranging_error_table(ARRAY, RANGES, BEARINGS, [0.01, 0.1])
    np.testing.assert_allclose(100 * table.exact[:, 1, 0, 1], [-5.02, -9.63, -21.1, -34.8], atol=0.06)
    np.testing.assert_allclose(100 * table.exact[:, 1, 0, 2], [-21.7, -35.7, -58.1, -73.5], atol=0.06)


def test_table_1_has_nothing_for_the_vertical_axis_of_a_level_array():
    table = pr.ranging_error_table(ARRAY, RANGES, BEARINGS, [0.01, 0.1])
    assert np.max(np.abs(table.exact[:, :, 2])) < 6.5e-4
    assert np.all(table.first_order[:, :, 2] == 0)


def test_vertical_displacement_matters_once_the_array_pitches_and_rolls():
    tilted = Triplet(pitch=np.radians(3), roll=np.radians(3))
    table = pr.ranging_error_table(tilted, [1e3, 5e3, 10e3], BEARINGS, [0.1])
    expected = [[-0.35, -0.16, 0.63], [-2.05, -1.01, 3.13], [-4.02, -2.00, 6.45]]
    np.testing.assert_allclose(100 * table.exact[:, 0, 2], expected, atol=0.011)


@pytest.mark.parametrize("spacing", [30.0, 50.0, 80.0])
def test_closed_form_agrees_with_exact_geometry(spacing):
    table = pr.ranging_error_table(Triplet(spacing=spacing), RANGES, BEARINGS, [-0.05, -0.01, 0.01, 0.1])
    trusted = table.first_order < 0.8
    assert np.count_nonzero(trusted) > 100
    np.testing.assert_allclose(table.exact[trusted], table.closed_form[trusted], atol=3e-3)


def test_displacement_away_from_the_target_makes_range_too_long_then_infinite_then_impossible():
    table = pr.ranging_error_table(ARRAY, RANGES, [0.0], [-0.1])
    np.testing.assert_allclose(100 * table.exact[:, 0, 1, 0], [8.8, 19, 67, 400], rtol=0.02)
    short = pr.ranging_error_table(Triplet(spacing=30.0), [5e3, 10e3], [0.0], [-0.1])
    assert np.all(np.isnan(short.exact[:, 0, 1, 0])) and np.all(np.isnan(short.closed_form[:, 0, 1, 0]))


def test_no_curvature_is_an_infinite_range_and_wrong_curvature_is_nan():
    assert pr.range_from_delays(ARRAY, 0.0, 0.0) == np.inf
    assert np.isnan(pr.range_from_delays(ARRAY, 0.0, -1e-6))
    assert pr.closed_form_error(-1.0) == np.inf
    assert np.isnan(pr.closed_form_error(-1.5))


def test_first_order_error_is_the_tangent_of_the_closed_form():
    ratio = np.array([-1e-5, 1e-5])
    np.testing.assert_allclose(pr.closed_form_error(ratio), pr.first_order_error(ratio), rtol=2e-5)


def test_broadside_displacement_is_worst_only_within_45_degrees_of_broadside():
    bearings = np.radians([0.0, 30.0, 44.0, 46.0, 60.0])
    table = np.abs(pr.ranging_error_table(ARRAY, [5e3], bearings, [0.01]).exact[0, 0])
    np.testing.assert_array_equal(table[1] > table[0], [True, True, True, False, False])


def test_a_wrong_sound_speed_biases_range():
    # Broadside: the delay difference is a² / (R c), so the range read is R (c_true / c_assumed).
    slow = replace(ARRAY, sound_speed=1485.0)
    assert measured_range(slow, ARRAY, 5e3, 0.0) / 5e3 == pytest.approx(1485 / 1500, rel=1e-4)


def test_delays_of_a_batch_of_displacements_are_those_of_each():
    offsets = np.array([[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    target = pr.target_at(2e3, 0.4)
    batch = np.stack(pr.arrival_delays(Triplet(displacement=offsets, pitch=0.05), target))
    for column, offset in zip(batch.T, offsets, strict=True):
        np.testing.assert_allclose(
            column, pr.arrival_delays(Triplet(displacement=tuple(offset), pitch=0.05), target), rtol=1e-12
        )


def test_jitter_of_the_difference_from_correlated_delays_drawn_at_random():
    # 200,000 draws: standard error of a standard deviation 0.16 %, so 0.7 % is more than 4 of them.
    rng = np.random.default_rng(33)
    for ratio in (0.05, 1.0, 8.0):
        link, own = np.sqrt(ratio), ratio
        h1, h2, h3 = link * rng.standard_normal((3, 200_000))
        tau12 = h1 - h2 + own * rng.standard_normal(200_000)
        tau23 = h2 - h3 + own * rng.standard_normal(200_000)
        expected = pr.curvature_jitter(np.sqrt(2 * ratio + ratio**2), ratio)
        assert np.std(tau12 - tau23) == pytest.approx(expected, rel=7e-3)


def test_range_jitter_against_a_monte_carlo_of_the_estimator():
    # 40,000 draws: standard error 0.35 %; a jitter of 0.5 % adds second-order terms of 0.01 %.
    rng = np.random.default_rng(34)
    bearing = np.radians(40.0)
    tau, eps = pr.mean_and_difference(*pr.arrival_delays(ARRAY, pr.target_at(4e3, bearing)))
    sigma = 0.005 * eps
    estimated = pr.range_from_delays(ARRAY, tau, eps + sigma * rng.standard_normal(40_000))
    assert np.std(estimated) / 4e3 == pytest.approx(pr.range_jitter(ARRAY, 4e3, bearing, sigma), rel=0.015)


def test_range_jitter_grows_with_range():
    jitter = pr.range_jitter(ARRAY, RANGES, 0.0, 2.64e-6)
    np.testing.assert_allclose(100 * jitter, [0.16, 0.32, 0.79, 1.59], atol=0.006)


def test_averaging_range_is_biased_and_averaging_curvature_is_not():
    # 20,000 averages of 100 samples, relative noise 0.2: standard errors 0.014 % (curvature), 0.05 % (range).
    rng = np.random.default_rng(35)
    curvature = 1 + 0.2 * rng.standard_normal((20_000, 100))
    assert np.mean(pr.range_of_average(curvature)) - 1 == pytest.approx(0.0004, abs=6e-4)
    assert np.mean(pr.average_of_range(curvature)) - 1 == pytest.approx(0.0465, abs=2.5e-3)


def test_average_of_no_curvature_is_infinite_or_impossible():
    assert pr.range_of_average([1.0, -1.0]) == np.inf
    assert np.isnan(pr.range_of_average([1.0, -2.0]))
    assert pr.average_of_range([0.0, 1.0]) == np.inf


def test_vertical_beamwidth_is_the_first_null_of_the_pattern():
    width = pr.vertical_beamwidth(4.0, 1500.0)
    assert np.degrees(width) == pytest.approx(14.48, abs=0.01)
    assert pr.vertical_pattern(width, 4.0, 1500.0) == pytest.approx(0.0, abs=1e-30)
    assert 10 * np.log10(pr.vertical_pattern(width / 2, 4.0, 1500.0)) == pytest.approx(-3.99, abs=0.02)


def test_equal_sources_pull_the_delay_to_the_middle_and_the_range_to_the_harmonic_mean():
    near, far = pr.target_at(4e3, 0.0), pr.target_at(8e3, 0.0)
    eps = [pr.mean_and_difference(*pr.arrival_delays(ARRAY, place))[1] for place in (near, far)]
    pulled = pr.range_from_delays(ARRAY, 0.0, pr.pulled_delay(*eps, 0.5))
    assert pulled == pytest.approx(2 * 4e3 * 8e3 / 12e3, rel=7e-4)


@given(st.floats(0.0, 1.0), st.floats(-1e-5, 1e-5))
def test_both_pull_laws_agree_for_near_delays(share, apart):
    phasor = pr.pulled_delay_phasor(0.0, apart, share, 1500.0)
    assert phasor == pytest.approx(pr.pulled_delay(0.0, apart, share), abs=3e-8)


def test_phasor_law_is_the_zero_of_two_sinusoidal_curves():
    apart, share, angular = 0.3e-3, 0.2, 2 * np.pi * 1500
    zero = pr.pulled_delay_phasor(0.0, apart, share, 1500.0)
    curve = (1 - share) * np.sin(angular * (0 - zero)) + share * np.sin(angular * (apart - zero))
    assert curve == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: Triplet(spacing=0.0), "spacing"),
        (lambda: Triplet(spacing=-50.0), "spacing"),
        (lambda: Triplet(displacement=(0.0, 1.0)), "displacement"),
        (lambda: Triplet(displacement=(0.0, np.nan, 0.0)), "displacement"),
        (lambda: Triplet(sound_speed=0.0), "sound_speed"),
        (lambda: Triplet(pitch=2.0), "pitch"),
        (lambda: pr.target_at(0.0, 0.0), "target_range"),
        (lambda: pr.foreshortening(ARRAY, np.pi / 2), "array axis"),
        (lambda: pr.range_from_delays(ARRAY, 50 / 1500, 1e-6), "array axis"),
        (lambda: pr.ranging_error_table(ARRAY, [5e3], [np.pi / 2], [0.01]), "array axis"),
        (lambda: pr.bearing_from_delay(ARRAY, 0.034), "tau must lie between"),
        (lambda: pr.arrival_delays(ARRAY, [1.0, 2.0]), "target must have shape"),
        (lambda: pr.curvature_jitter(1e-6, -1.0), "noise_ratio"),
        (lambda: pr.vertical_beamwidth(0.5, 1500.0), "one wavelength"),
        (lambda: pr.pulled_delay(0.0, 1e-4, 1.5), "power_share"),
        (lambda: pr.pulled_delay_phasor(0.0, 4e-4, 0.5, 1500.0), "unwanted_delay - target_delay"),
    ],
)
def test_bad_input_is_refused_in_words(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_a_pitched_array_has_no_blind_axis_in_the_horizontal_plane():
    assert pr.foreshortening(Triplet(pitch=0.1), np.pi / 2) == pytest.approx(np.sin(0.1) ** 2)
