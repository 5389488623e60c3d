"""Beams against array theory, a dense matrix inverse, and the phase speed of the modes."""

import numpy as np
import pytest

from labsim.beamforming import (
    bearing_track,
    block_to_frames,
    conventional_record,
    mean_phase_speed,
    mvdr_record,
    parabola_offset,
    steer,
    steering,
)
from labsim.waveguide import HorizontalArray, PekerisWaveguide, array_field, ship_sound, solve_modes

LINE = HorizontalArray(elements=24, spacing=1.5, band=(300.0, 320.0))
LOOK = np.radians(np.arange(20, 160.1, 0.5))


def plane_waves(rng, bearings, frames, noise=0.01):
    """Independent plane waves of unit power plus noise, (frames, elements, bins)."""
    shape = (frames, LINE.elements, LINE.frequency.size)
    field = noise * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)
    for bearing in bearings:
        source = rng.standard_normal((2, frames, 1, LINE.frequency.size))
        wave = steering(LINE, LINE.frequency, bearing).T
        field = field + wave * (source[0] + 1j * source[1]) / np.sqrt(2)
    return field.astype(np.complex64)


def test_a_conventional_beam_passes_its_direction_and_is_blind_where_theory_says():
    single = HorizontalArray(elements=24, spacing=1.5, band=(300.5, 301.0))
    field = np.broadcast_to(steering(single, single.frequency, np.pi / 2).T, (1, 24, 1))
    null = np.arccos(1505 / (24 * 1.5 * single.frequency[0]))
    power = conventional_record(field, single, np.array([np.pi / 2, null]), frames=1)[0]
    assert power[0] == pytest.approx(1.0, rel=1e-5)
    assert power[1] < 1e-9


def test_mvdr_by_woodbury_equals_the_dense_inverse():
    field = plane_waves(np.random.default_rng(1), [1.0, 1.8], 7, noise=0.3)
    record = mvdr_record(field, LINE, LOOK[::40], frames=7, loading=0.5)
    expected = 0
    for index, frequency in enumerate(LINE.frequency):
        x = field[:, :, index].T.astype(complex)
        covariance = x @ x.conj().T / 7
        covariance += 0.5 * np.trace(covariance).real / LINE.elements * np.eye(LINE.elements)
        a = steering(LINE, frequency, LOOK[::40])
        quadratic = np.einsum("be,ef,bf->b", a.conj(), np.linalg.inv(covariance), a).real
        expected = expected + 1 / quadratic / LINE.frequency.size
    assert np.allclose(record[0], expected, rtol=1e-4)


def test_mvdr_separates_two_ships_that_one_conventional_beam_joins():
    """4 degrees apart, beam 8 degrees wide; 48 frames, seed 2."""
    pair = np.radians([88.0, 92.0])
    field = plane_waves(np.random.default_rng(2), pair, 48)
    between = np.argmin(np.abs(LOOK - np.pi / 2))
    at = np.argmin(np.abs(LOOK[:, None] - pair), axis=0)
    conventional = conventional_record(field, LINE, LOOK, frames=48)[0]
    mvdr = mvdr_record(field, LINE, LOOK, frames=48, loading=0.01)[0]
    assert conventional[between] > 0.9 * conventional[at].max()
    assert mvdr[between] < 0.5 * mvdr[at].min()


@pytest.mark.parametrize("method", [conventional_record, mvdr_record])
def test_both_records_find_a_ship_in_noise(method):
    """-15 dB at one receiver of the paper's array, 12 frames; 0.15 degrees is three times the scatter."""
    sea, array = PekerisWaveguide(), HorizontalArray()
    modes = solve_modes(sea, array.frequency)
    bearing = np.full(24, np.radians(70.0))
    field = array_field(modes, array, np.full(24, 9e3), bearing)
    ship_sound(np.random.default_rng(3), field, np.mean(np.abs(field[:, 0]) ** 2) * 10**1.5)
    look = np.radians(np.arange(55, 90, 0.5))
    speed = mean_phase_speed(modes, 3.0, 20.0, 9e3)
    found = bearing_track(method(field, array, look, speed), look)
    assert found.shape == (2,)
    assert np.max(np.abs(np.degrees(found) - 70.0)) < 0.15


def test_a_waveguide_leans_bearings_to_broadside_by_half_a_degree_unless_steered_at_its_phase_speed():
    """At 60 degrees cos(theta) is seen as 0.9833 cos(theta): 0.55 degrees; no noise."""
    sea, array = PekerisWaveguide(), HorizontalArray()
    modes = solve_modes(sea, array.frequency)
    speed = mean_phase_speed(modes, 3.0, 20.0, 10e3)
    assert speed == pytest.approx(1530.5, abs=0.5)
    assert mean_phase_speed(solve_modes(sea, 30.0), 3.0, 20.0, 10e3) > 1550
    field = array_field(modes, array, np.full(12, 10e3), np.full(12, np.pi / 3))
    look = np.radians(np.arange(50, 70, 0.5))
    lean = [np.degrees(bearing_track(conventional_record(field, array, look, c), look))[0] - 60
            for c in (sea.water_speed, speed)]  # fmt: skip
    assert lean[0] == pytest.approx(0.53, abs=0.05)
    assert abs(lean[1]) < 0.05


def test_the_following_beam_keeps_the_ship_and_gains_18_db_against_noise():
    """64 receivers: noise power falls by 64; 200 frames x 410 bins, standard error 0.4 %."""
    array = HorizontalArray()
    bearing = np.linspace(0.5, 2.0, 200)
    phase = 2 * np.pi * array.frequency / 1505.0 * np.cos(bearing)[:, None]
    wave = np.exp(1j * phase[:, None, :] * array.positions[:, None]).astype(np.complex64)
    assert np.max(np.abs(steer(wave, array, bearing) - 1)) < 1e-5
    rng = np.random.default_rng(4)
    noise = (rng.standard_normal(wave.shape) + 1j * rng.standard_normal(wave.shape)).astype(np.complex64)
    assert np.mean(np.abs(steer(noise, array, bearing)) ** 2) == pytest.approx(2 / 64, rel=0.015)


def test_the_parabola_finds_the_top_between_beams_and_never_leaves_its_step():
    grid = np.linspace(-1, 1, 21)
    record = np.exp(-((grid - np.array([[0.234], [-0.51]])) ** 2))
    assert np.allclose(bearing_track(record, grid), [0.234, -0.51], atol=1e-12)
    assert parabola_offset(np.array([1.0, 1.0, 1.0]), np.array(1)) == 0
    assert abs(parabola_offset(np.array([0.0, 1.0, 1.0 - 1e-9]), np.array(1))) <= 0.5
    assert parabola_offset(np.array([5.0, 1.0, 0.9]), np.array(1)) in (-0.5, 0.0, 0.5)


def test_block_bearings_are_read_at_frames_along_straight_lines():
    frames = np.arange(53)
    blocks = (2.0 + 0.1 * frames)[:48].reshape(4, 12).mean(axis=1)
    assert np.allclose(block_to_frames(blocks, 12, 53), 2.0 + 0.1 * frames)
    assert np.array_equal(block_to_frames(blocks[:1], 12, 15), np.full(15, blocks[0]))


def test_a_beam_at_the_edge_is_not_refined_and_an_empty_neighbour_does_no_harm():
    bearing = np.radians(np.arange(50, 60, 0.5))
    record = np.exp(-(((np.arange(20.0) + 2) / 6) ** 2))
    assert bearing_track(np.stack([record, record[::-1]]), bearing) == pytest.approx(bearing[[0, -1]])
    record = np.zeros((2, 20))
    record[0, 7] = 1.0
    found = bearing_track(record, bearing)
    assert found[0] == pytest.approx(bearing[7]) and np.isnan(found[1])
    with pytest.raises(ValueError, match="record must not be negative"):
        bearing_track(-record, bearing)


@pytest.mark.parametrize("method", [conventional_record, mvdr_record])
def test_silence_has_no_power_in_any_direction(method):
    field = plane_waves(np.random.default_rng(1), [1.0], 8)
    field[:4] = 0
    record = method(field, LINE, LOOK, frames=4)
    assert np.all(record[0] == 0) and np.all(record[1] > 0)


@pytest.mark.parametrize("method", [conventional_record, mvdr_record])
def test_what_does_not_fit_is_refused_in_words(method):
    field = plane_waves(np.random.default_rng(1), [1.0], 4)
    with pytest.raises(ValueError, match="field must have shape"):
        method(field[:, :5], LINE, LOOK)
    with pytest.raises(ValueError, match="frames must be a whole number from 1 to 4"):
        method(field, LINE, LOOK, frames=12)
    with pytest.raises(ValueError, match="phase_speed must be above 0"):
        method(field, LINE, LOOK, phase_speed=0.0, frames=4)


def test_loading_and_bearings_are_checked():
    field = plane_waves(np.random.default_rng(1), [1.0], 4)
    with pytest.raises(ValueError, match="loading must be above 0"):
        mvdr_record(field, LINE, LOOK, frames=4, loading=0.0)
    with pytest.raises(ValueError, match="bearing must be finite"):
        steer(field, LINE, np.full(4, np.nan))
    with pytest.raises(ValueError, match="number of beams must lie between 3"):
        bearing_track(np.ones((4, 2)), np.array([0.0, 1.0]))
