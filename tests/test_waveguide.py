"""The modes against theory and an independent code; the field against a wavenumber integral."""

import dataclasses

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from labsim.waveguide import (
    HorizontalArray,
    PekerisWaveguide,
    array_field,
    beam_sound,
    characteristic,
    group_delay_difference,
    mode_strength,
    pressure,
    ship_sound,
    solve_modes,
)

SEA = PekerisWaveguide()
LOSSLESS = dataclasses.replace(SEA, bottom_attenuation_db=0.0)

# Horizontal wavenumbers, 1/m, from pykrak 3.0.1 (H. Akins; a translation of KRAKEN, finite differences with
# Richardson extrapolation), numpy 2.3.5, 20,000 mesh points, phase speeds from 1400 to 1596 m/s.
PYKRAK_LOSSLESS = {
    100.0: [0.4136952846502289, 0.40165649127485004],
    300.0: [1.2508070486125045, 1.245805135301225, 1.2373611319883149, 1.2253542629166445, 1.2096861700104213,
            1.1904547503859826],
    500.0: [2.086379853312396, 2.0832014556554066, 2.077881688880045, 2.0703898918446524, 2.060688089874913,
            2.048734433152444, 2.034487274409969, 2.0179126851639313, 1.999007414638446, 1.9779324083718088],
}  # fmt: skip
PYKRAK_LOSSY = {
    100.0: [0.41369494629906456 - 2.449860771344851e-05j, 0.4016534372939781 - 1.0186768869293134e-04j],
    300.0: [1.2508069932395642 - 4.488705498234224e-06j, 1.2458049128810718 - 1.7045261423009176e-05j,
            1.2373606083045936 - 3.601155613981743e-05j, 1.225353177656736 - 6.148912091224237e-05j,
            1.2096836029496334 - 1.0018130257904663e-04j, 1.1904402547219197 - 2.0422159375662282e-04j],
    500.0: [2.0863798313574526 - 1.799268575118401e-06j, 2.083201368089849 - 7.030047550828268e-06j,
            2.077881491740326 - 1.526932657362423e-05j, 2.0703895367654352 - 2.6044589065235894e-05j,
            2.0606875136217124 - 3.908334557300292e-05j, 2.0487335333392886 - 5.45927286691769e-05j,
            2.034485846445384 - 7.369732070642268e-05j, 2.0179102104541875 - 9.964696406898794e-05j,
            1.999001946224 - 1.4303046794362554e-04j, 1.977901768137834 - 2.723467908869397e-04j],
}  # fmt: skip


@pytest.fixture(scope="module")
def modes():
    return solve_modes(SEA, HorizontalArray().frequency)


def test_the_characteristic_equation_is_solved_to_rounding(modes):
    number = np.arange(1, modes.count + 1)[:, None]
    residual = characteristic(SEA, modes.frequency, modes.vertical, number)
    assert np.nanmax(np.abs(residual)) <= 1e-12


def test_two_modes_are_trapped_at_100_hz_and_ten_at_500_hz(modes):
    trapped = np.sum(np.isfinite(modes.wavenumber), axis=0)
    assert modes.frequency.size == 410
    assert SEA.mode_count(100.0) == 2 and trapped[0] == 2
    assert SEA.mode_count(500.0) == 10 and trapped[-1] == 10
    assert np.array_equal(trapped, SEA.mode_count(modes.frequency))


@pytest.mark.parametrize("frequency", [100.0, 300.0, 500.0])
def test_wavenumbers_agree_with_an_independent_normal_mode_code(frequency):
    ours, reference = solve_modes(LOSSLESS, frequency).wavenumber[:, 0], np.array(PYKRAK_LOSSLESS[frequency])
    assert np.max(np.abs(ours / reference - 1)) <= 1e-6


@pytest.mark.parametrize("frequency", [100.0, 300.0, 500.0])
def test_lossy_wavenumbers_agree_within_second_order_perturbation(frequency):
    """The other code keeps the loss in the eigenproblem; ours adds it to first order, hence 2e-5."""
    modes, reference = solve_modes(SEA, frequency), np.array(PYKRAK_LOSSY[frequency])
    assert np.max(np.abs(modes.wavenumber[:, 0] / reference.real - 1)) <= 2e-5
    assert np.max(np.abs(modes.attenuation[:, 0] / -reference.imag - 1)) <= 0.03


def test_the_second_order_error_of_the_loss_falls_with_its_square():
    """Complex Newton roots of the lossy characteristic equation; halving the loss quarters the error."""
    real = solve_modes(SEA, 300.0).wavenumber
    shift = [np.abs(_complex_roots(loss_db).real - real) for loss_db in (0.12, 0.06)]
    assert np.all(np.abs(shift[0][:5] / shift[1][:5] - 4) < 0.1)


def test_perturbation_is_good_from_ten_per_cent_above_cutoff_on(modes):
    """All 2,451 modes of the scene against complex Newton roots; at cutoff itself it is 25 times worse."""
    exact = _complex_roots(0.12, modes.frequency)
    above = modes.frequency / SEA.cutoff_frequency(np.arange(1, modes.count + 1))[:, None]
    trapped = np.isfinite(modes.wavenumber)
    error = np.abs(modes.wavenumber / exact.real - 1)
    assert np.sum(trapped) == 2451
    assert np.max(error[trapped & (above > 1.1)]) <= 2e-5
    assert np.max(np.abs(modes.attenuation / -exact.imag - 1)[trapped & (above > 1.1)]) <= 6e-3
    assert 2e-4 < np.max(error[trapped]) < 6e-4


def test_group_speed_is_the_slope_of_the_dispersion_curve(modes):
    step = 1e-3
    below, above = (solve_modes(SEA, modes.frequency[:-1] + shift) for shift in (-step, step))
    slope = 2 * np.pi * 2 * step / (above.wavenumber - below.wavenumber)
    well_trapped = modes.decay[:, :-1] > 0.02
    ratio = slope / modes.group_speed[:, :-1]
    assert np.max(np.abs(ratio[well_trapped] - 1)) < 1e-6


def test_mode_shapes_are_orthonormal_under_the_weight_of_density():
    modes = solve_modes(SEA, 400.0)
    depth = np.arange(0.005, 700, 0.01)
    density = np.where(depth < SEA.depth, SEA.water_density, SEA.bottom_density)
    shapes = modes.shape(depth)[..., 0]
    assert np.allclose(shapes.T @ (shapes / density[:, None]) * 0.01, np.eye(modes.count), atol=2e-4)


@settings(max_examples=30, deadline=None)
@given(scale=st.floats(0.2, 5.0))
def test_a_scaled_sea_has_scaled_modes(scale):
    """Twice the depth at half the frequency is the same guide drawn larger."""
    small = solve_modes(SEA, 300.0)
    large = solve_modes(dataclasses.replace(SEA, depth=SEA.depth * scale), 300.0 / scale)
    assert np.allclose(large.wavenumber * scale, small.wavenumber, rtol=1e-12)
    assert np.allclose(large.group_speed, small.group_speed, rtol=1e-9)


def test_group_delays_of_the_paper_scene_are_tens_of_milliseconds():
    """10 km, 282.8 Hz. Expected: slopes dk/dw of the dispersion curve, roots found by scipy's `brentq`."""
    centre = np.sqrt(200.0 * 400.0)

    def wavenumber(number, frequency):
        water, bottom = 2 * np.pi * frequency / SEA.water_speed, 2 * np.pi * frequency / SEA.bottom_speed

        def mismatch(k):
            up, down = np.sqrt(water**2 - k**2), np.sqrt(k**2 - bottom**2)
            ratio = SEA.bottom_density * up / (SEA.water_density * down)
            return up * SEA.depth + np.arctan(ratio) - number * np.pi

        return scipy.optimize.brentq(mismatch, bottom * (1 + 1e-12), water * (1 - 1e-12), xtol=1e-15)

    arrival = [10e3 * np.diff([wavenumber(n, centre + df) for df in (-0.05, 0.05)])[0] / (0.2 * np.pi)
               for n in range(1, 5)]  # fmt: skip
    modes = solve_modes(SEA, centre)
    for first, second in ((2, 4), (1, 2)):
        expected = arrival[second - 1] - arrival[first - 1]
        assert group_delay_difference(modes, first, second, 10e3)[0] == pytest.approx(expected, rel=1e-5)
    assert arrival[3] - arrival[1] == pytest.approx(0.109, abs=0.001)


@pytest.mark.parametrize("loss_db, error", [(0.12, 0.04), (0.01, 0.004)])
def test_pressure_agrees_with_the_wavenumber_integral(loss_db, error):
    """The exact field of the lossy guide, summed over wavenumber on a contour above the poles.

    Constant, phase and decay are fixed at once. What is left at the paper's loss, 3 %, is the first-order
    treatment of the loss: it vanishes with the loss.
    """
    sea = dataclasses.replace(SEA, bottom_attenuation_db=loss_db)
    distance = np.array([4000.0, 5000.0, 6000.0])
    ours = pressure(solve_modes(sea, 150.0), distance)[:, 0]
    exact = _wavenumber_integral(sea, 150.0, distance)
    assert np.max(np.abs(ours - exact)) < error * np.sqrt(np.mean(np.abs(exact) ** 2))


def test_pressure_is_reciprocal(modes):
    assert np.allclose(pressure(modes, 8e3, 3.0, 20.0), pressure(modes, 8e3, 20.0, 3.0), rtol=1e-12)


def test_array_field_agrees_with_direct_double_precision(modes):
    """Also across a chunk boundary; 1e-5 of the strongest value."""
    array, distance = HorizontalArray(), np.linspace(3e3, 12e3, 20)
    bearing = np.linspace(0.3, 2.8, 20)
    field = array_field(modes, array, distance, bearing)
    direct = _direct(modes, array, distance, bearing, distance)
    assert field.dtype == np.complex64
    assert np.max(np.abs(field - direct)) <= 1e-5 * np.max(np.abs(direct))


def test_wavefront_curvature_across_the_array_is_the_documented_few_per_cent(modes):
    array, distance, bearing = HorizontalArray(), np.array([9e3]), np.array([1.2])
    source = distance * np.array([np.cos(bearing), np.sin(bearing)])
    exact_range = np.hypot(source[0] - array.positions[:, None], source[1]).T
    direct = _direct(modes, array, distance, bearing, None, exact_range)
    error = np.abs(array_field(modes, array, distance, bearing) - direct)
    assert np.max(error) <= 0.04 * np.max(np.abs(direct))


def test_progress_reaches_one_and_memory_is_obeyed(modes):
    seen = []
    array = HorizontalArray(elements=4)
    array_field(modes, array, np.full(40, 5e3), np.full(40, 1.0), progress=seen.append)
    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) == 3
    with pytest.raises(ValueError, match="memory must be at least .* 0.1 MB was given"):
        array_field(modes, array, np.full(40, 5e3), np.full(40, 1.0), memory=1e5)


def test_the_ship_and_the_sea_add_their_powers(modes):
    """40 frames x 8 receivers x 410 bins: relative standard error of the noise power 0.3 %."""
    array = HorizontalArray(elements=8)
    clean = array_field(modes, array, np.full(40, 8e3), np.full(40, 1.0))
    power = np.mean(np.abs(clean) ** 2)
    heard = ship_sound(np.random.default_rng(1), clean.copy(), power)
    assert np.mean(np.abs(heard) ** 2) == pytest.approx(2 * power, rel=0.02)
    shorter = ship_sound(np.random.default_rng(1), clean[:10].copy(), power)
    assert np.array_equal(shorter, heard[:10])
    quiet = ship_sound(np.random.default_rng(1), clean.copy(), 1e-20)
    assert np.allclose(np.abs(quiet), np.abs(clean), rtol=1e-5)
    with pytest.raises(ValueError, match="noise_power must be above 0"):
        ship_sound(np.random.default_rng(1), clean, 0.0)


def test_a_beam_hears_the_ship_as_one_receiver_does_and_less_of_the_sea():
    """-10 dB at one of 16 receivers: noise of 10 / 16 of the signal; 300 x 410 values, error 0.4 %."""
    clean = np.exp(1j * np.linspace(0, 9, 300 * 410)).reshape(300, 410)
    heard = beam_sound(np.random.default_rng(2), clean, -10.0, 16)
    assert heard.shape == clean.shape and heard.dtype == np.complex64
    assert np.mean(np.abs(heard) ** 2) == pytest.approx(1 + 10 / 16, rel=0.015)
    assert np.array_equal(beam_sound(np.random.default_rng(2), clean, -10.0, 16), heard)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"bottom_speed": 1505.0}, "bottom_speed must be above water_speed"),
        ({"bottom_speed": 1400.0}, "bottom_speed must be above water_speed"),
        ({"depth": 0.0}, "depth must be above 0"),
        ({"depth": np.nan}, "depth must be finite"),
        ({"bottom_attenuation_db": -1.0}, "bottom_attenuation_db must lie between 0 and 10"),
    ],
)
def test_a_sea_that_cannot_guide_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        PekerisWaveguide(**change)


@pytest.mark.parametrize(
    "change, words",
    [
        ({"elements": 1}, "elements must be a whole number from 2 to 4096, but 1"),
        ({"elements": 2.5}, "elements must be a whole number from 2 to 4096, but 2.5"),
        ({"spacing": -1.0}, "spacing"),
        ({"band": (300.0, 200.0)}, r"band must be \(low, high\) with low below high within 0 to 2000"),
        ({"band": (300.0, 2001.0)}, "within 0 to 2000"),
        ({"band": (300.0, 300.5)}, "band must hold a multiple of 0.976562 Hz"),
    ],
)
def test_an_impossible_array_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        HorizontalArray(**change)


def test_frequencies_below_cutoff_are_refused_in_words():
    cutoff = SEA.cutoff_frequency(1)
    with pytest.raises(ValueError, match="frequency must be above 25.12 Hz"):
        solve_modes(SEA, cutoff - 0.1)
    assert solve_modes(SEA, cutoff + 0.1).count == 1
    with pytest.raises(ValueError, match="must increase"):
        solve_modes(SEA, [200.0, 100.0])
    with pytest.raises(ValueError, match="frequency must be finite"):
        solve_modes(SEA, np.nan)


def test_a_pulse_needs_its_two_modes(modes):
    with pytest.raises(ValueError, match="mode 4 must be trapped, but only 2 modes are trapped at 100"):
        group_delay_difference(modes, 2, 4, 10e3)
    assert np.all(np.isfinite(group_delay_difference(modes, 1, 2, 10e3)))


def test_a_vessel_on_top_of_the_receiver_and_a_source_in_the_bottom_are_refused(modes):
    with pytest.raises(ValueError, match="distance must be above 0"):
        pressure(modes, 0.0)
    with pytest.raises(ValueError, match="distance must be above 0"):
        array_field(modes, HorizontalArray(), [5e3, 0.0], [1.0, 1.0])
    with pytest.raises(ValueError, match="bearing must have shape"):
        array_field(modes, HorizontalArray(), [5e3, 4e3], [1.0])
    with pytest.raises(ValueError, match="source_depth must lie between 0 and 45"):
        pressure(modes, 5e3, source_depth=50.0)


def _complex_roots(loss_db, frequency=300.0):
    """Horizontal wavenumbers of the guide with a complex bottom (N, F), by Newton on complex k_z."""
    sea = dataclasses.replace(SEA, bottom_attenuation_db=loss_db)
    frequency = np.atleast_1d(frequency)
    omega = 2 * np.pi * frequency
    loss = loss_db / (20 / np.log(10)) * frequency / sea.bottom_speed
    water, bottom = omega / sea.water_speed, omega / sea.bottom_speed - 1j * loss
    vertical = solve_modes(sea, frequency).vertical.astype(complex)
    number = np.arange(1, vertical.shape[0] + 1)[:, None]

    def equation(vertical):
        decay = np.sqrt(water**2 - bottom**2 - vertical**2)
        decay = np.where(decay.real < 0, -decay, decay)
        ratio = sea.bottom_density * vertical / (sea.water_density * decay)
        return vertical * sea.depth + np.arctan(ratio) - number * np.pi

    with np.errstate(invalid="ignore"):
        for _ in range(60):
            slope = (equation(vertical + 1e-7) - equation(vertical - 1e-7)) / 2e-7
            vertical = vertical - equation(vertical) / slope
        assert np.nanmax(np.abs(equation(vertical))) < 1e-9
    return np.sqrt(water**2 - vertical**2)


def _wavenumber_integral(sea, frequency, distance, source_depth=3.0, receiver_depth=20.0):
    """4 pi times the Green function: integral of G(k_r) H0(k_r r) k_r, far-field Hankel function."""
    omega = 2 * np.pi * frequency
    loss = sea.bottom_attenuation_db / (20 / np.log(10)) * frequency / sea.bottom_speed
    water, bottom = omega / sea.water_speed, omega / sea.bottom_speed - 1j * loss
    step = 2 * np.pi / (60 * distance.max())
    real = np.arange(0.5 * bottom.real, 1.1 * water, step)
    k = real + 1j * 3 / (15 * distance.max())
    vertical = np.sqrt(water**2 - k**2 + 0j)
    decay = np.sqrt(k**2 - bottom**2 + 0j)
    decay = np.where(decay.real < 0, -decay, decay)
    upper, lower = min(source_depth, receiver_depth), max(source_depth, receiver_depth)
    beyond = sea.depth - lower
    mix = sea.water_density / sea.bottom_density * decay / vertical
    rising = np.cos(vertical * beyond) + mix * np.sin(vertical * beyond)
    total = np.cos(vertical * sea.depth) + mix * np.sin(vertical * sea.depth)
    green = np.sin(vertical * upper) / vertical * rising / total
    hankel = np.sqrt(2 / (np.pi * k * distance[:, None])) * np.exp(-1j * (k * distance[:, None] - np.pi / 4))
    edge = np.clip((real - real[0]) / (0.2 * bottom.real), 0, 1)
    taper = np.sin(edge * np.pi / 2) ** 2 * np.clip((real[-1] - real) / (0.05 * water), 0, 1)
    return np.sum(taper * green * hankel * k, axis=-1) * step


def _direct(modes, array, distance, bearing, amplitude_range=None, ranges=None):
    if ranges is None:
        ranges = distance[:, None] - np.cos(bearing)[:, None] * array.positions
    scale = ranges if amplitude_range is None else np.broadcast_to(amplitude_range[:, None], ranges.shape)
    strength = mode_strength(modes, 3.0, array.depth)
    rate = np.nan_to_num(modes.attenuation + 1j * modes.wavenumber)
    total = sum(s * np.exp(-k * ranges[..., None]) for s, k in zip(strength, rate, strict=True))
    return np.exp(-0.25j * np.pi) * np.sqrt(2 * np.pi / scale[..., None]) * total
