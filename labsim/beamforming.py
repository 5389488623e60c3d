"""Bearings from a line of receivers: conventional and minimum-variance (MVDR) beams over many frequencies.

A plane wave from bearing theta reaches the receiver at x earlier by x cos(theta) / c than the centre;
undoing that delay and adding the receivers up points the array. MVDR (Capon 1969) chooses weights that let
the look direction pass and everything else as little as possible; it needs a covariance, averaged over
frames and loaded, because there are fewer frames than receivers. In a waveguide sound does not travel along
the array at c but at the faster phase speed of its modes: steered at c, every bearing leans to broadside.
"""

import numpy as np
from scipy.interpolate import make_interp_spline

from labsim.arguments import (
    require_between,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
    require_whole,
)
from labsim.waveguide import mode_strength


def steering(array, frequency, bearing, phase_speed=1505.0):
    """What a plane wave of unit strength does to the receivers: exp(i k x cos(bearing)).

    frequency : Hz, bearing : radians, shapes that broadcast; phase_speed : m/s
    Returns complex64 (..., elements).
    """
    wavenumber = 2 * np.pi * np.asarray(frequency) / require_positive("phase_speed", phase_speed)
    phase = np.asarray(wavenumber * np.cos(bearing))[..., None] * array.positions
    return np.exp(1j * phase).astype(np.complex64)


def mean_phase_speed(modes, source_depth, receiver_depth, distance):
    """The phase speed at which the array hears the sound on average, m/s.

    Weights each mode and frequency with its power at `distance`, m: w / (mean of k_n / k) of a
    bearing cosine that mode n shows as (k_n / k) cos(theta).
    """
    strength = mode_strength(modes, source_depth, receiver_depth)
    distance = require_positive("distance", distance)
    power = strength**2 * np.exp(-2 * np.nan_to_num(modes.attenuation) * distance)
    slowness = np.nan_to_num(modes.wavenumber) / (2 * np.pi * modes.frequency)
    return np.sum(power) / np.sum(power * slowness)


def conventional_record(field, array, bearing, phase_speed=1505.0, frames=12):
    """Power of conventional beams against time: |a^H x / E|^2, mean over frequencies and blocks of frames.

    field : complex (K, E, F), F the array's own frequencies; bearing : (B,), radians
    frames : frames averaged into one row; an incomplete last block is left out
    Returns (K // frames, B). Raises ValueError for shapes that do not fit.
    """
    field, blocks = _blocks(field, array, frames)
    record = np.zeros((blocks, np.size(bearing)))
    for index, frequency in enumerate(array.frequency):
        weights = steering(array, frequency, bearing, phase_speed).conj().T / array.elements
        beams = field[..., index] @ weights
        record += np.mean(np.abs(beams) ** 2, axis=1) / array.frequency.size
    return record


def mvdr_record(field, array, bearing, phase_speed=1505.0, frames=12, loading=1.0):
    """Power of MVDR beams against time: 1 / (a^H R^-1 a), mean over frequencies.

    R is the covariance over a block of frames plus `loading` times its mean diagonal on the diagonal. With
    fewer frames L than receivers, Woodbury's identity leaves L x L systems:
    a^H R^-1 a = (E - y^H (m L I + X^H X)^-1 y) / m with y = X^H a and m the loading.
    Arguments and result as for `conventional_record`, 0 for silence; raises ValueError also for a loading
    not above 0.
    """
    require_positive("loading", loading)
    field, blocks = _blocks(field, array, frames)
    record = np.zeros((blocks, np.size(bearing)))
    for index, frequency in enumerate(array.frequency):
        snapshots = np.ascontiguousarray(field[..., index])
        level = loading * np.mean(np.abs(snapshots) ** 2, axis=(1, 2))[:, None, None]
        diagonal = np.where(level > 0, level, 1) * frames * np.eye(frames, dtype=np.float32)
        gram = snapshots.conj() @ snapshots.swapaxes(1, 2) + diagonal
        y = snapshots.conj() @ steering(array, frequency, bearing, phase_speed).T
        fitted = np.sum((y.conj() * np.linalg.solve(gram, y)).real, axis=1)
        record += level[:, 0] / (array.elements - fitted) / array.frequency.size
    return record


def bearing_track(record, bearing):
    """Bearing of the strongest beam of every row, refined by a parabola through three points in decibels.

    The first and the last beam have one neighbour only and are not refined: there the source may be outside.
    record : (..., B), power; bearing : (B,), radians, evenly spaced
    Returns (...), radians, NaN for silence. Raises ValueError for fewer than three beams or a negative power.
    """
    bearing = require_shape("bearing", require_finite("bearing", bearing), (None,))
    require_between("number of beams", bearing.size, 3, np.inf)
    record = require_shape("record", require_not_negative("record", record), bearing.shape)
    peak = np.argmax(record, axis=-1)
    inner = np.clip(peak, 1, bearing.size - 2)
    offset = parabola_offset(np.log(np.maximum(record, np.finfo(float).tiny)), inner)
    track = bearing[peak] + np.where(peak == inner, (bearing[1] - bearing[0]) * offset, 0)
    return np.where(np.any(record > 0, axis=-1), track, np.nan)


def parabola_offset(values, peak):
    """Where a parabola through the peak and its neighbours has its top, in steps from the peak, within 0.5.

    values : (..., n); peak : (...), index of the peak, 1 ... n - 2
    """
    left, top, right = (
        np.take_along_axis(values, (peak + shift)[..., None], axis=-1)[..., 0] for shift in (-1, 0, 1)
    )
    curve = left - 2 * top + right
    offset = (left - right) / np.where(curve < 0, 2 * curve, -np.inf)
    return np.clip(offset, -0.5, 0.5)


def block_to_frames(values, frames, count):
    """Values of blocks of frames (n,) read at every frame (count,): lines through the block middles.

    The first and the last line run on to the ends; a single block gives its value to all frames.
    """
    if values.size == 1:
        return np.full(count, values[0])
    middle = np.arange(values.size) * frames + (frames - 1) / 2
    return make_interp_spline(middle, values, k=1)(np.arange(count))


def steer(field, array, bearing, phase_speed=1505.0):
    """The beam that follows a vessel: a(theta_k)^H x_k / E.

    field : complex64 (K, E, F); bearing : (K,), radians
    Returns complex64 (K, F).
    """
    bearing = require_shape("bearing", require_finite("bearing", bearing), field.shape[:1])
    wavenumber = 2 * np.pi * array.frequency / require_positive("phase_speed", phase_speed)
    phase = np.cos(bearing)[:, None] * wavenumber
    weight = np.exp(-1j * phase * array.positions[0]).astype(np.complex64)
    step = np.exp(-1j * phase * array.spacing).astype(np.complex64)
    beam = np.zeros(phase.shape, dtype=np.complex64)
    for element in range(array.elements):
        beam += weight * field[:, element]
        weight *= step
    return beam / array.elements


def _blocks(field, array, frames):
    expected = (array.elements, array.frequency.size)
    if field.ndim != 3 or field.shape[1:] != expected:
        raise ValueError(f"field must have shape (frames, {expected[0]}, {expected[1]}), not {field.shape}")
    require_whole("frames", frames, 1, field.shape[0])
    blocks = field.shape[0] // frames
    return field[: blocks * frames].reshape(blocks, frames, *expected), blocks
