"""Frequency-domain beta-warping: it turns the interference of two modes into a pulse whose delay is range.

Two modes beat in the power spectrum as cos(gamma r f^(-1/beta)), with the waveguide invariant beta near 1.
Reading the spectrum at f -> C f^(-beta) straightens the beat into a tone, and its Fourier transform into a
pulse at a delay proportional to range. Misjudge beta, and every delay is wrong by one factor: the ratio of
two delays is the ratio of the ranges all the same (Dong, Guo, Xu and Yan, Journal of Applied Acoustics 2020,
eqs. 1-9; delays of modes and their group speeds: tau = beta (t_m - t_n), which is not in the paper).
"""

import numpy as np
from scipy.interpolate import CubicSpline

from labsim.arguments import (
    require_between,
    require_finite,
    require_interval,
    require_positive,
    require_shape,
    require_whole,
)
from labsim.beamforming import parabola_offset
from labsim.waveguide import group_delay_difference, solve_modes

BAND = (200.0, 400.0)


def stripe_contrast(spectrum, frequency, ratio, beta, band=BAND):
    """How much of a spectrum's pattern keeps still when every row is read along its stripes, f ~ r^beta.

    Chuprov's invariant: where a stripe crosses f at the first range, it crosses f M^beta at M times that
    range. Read so, the rows of the right beta agree, and their mean keeps its contrast.
    spectrum : (K, F), power; frequency : (F,), Hz, evenly spaced; ratio : M (K,); beta : assumed invariant
    band : (low, high), Hz, of the first row; the other rows must find theirs within `frequency`
    Returns the variance of the mean row over the mean variance of the rows, between about 1 / K and 1.
    Raises ValueError where the stripes leave `frequency`.
    """
    step = frequency[1] - frequency[0]
    wanted = np.arange(band[0], band[1], step) * require_positive("ratio", ratio)[:, None] ** beta
    require_between("stripe frequency", wanted, frequency[0], frequency[-1])
    place = (wanted - frequency[0]) / step
    below = np.minimum(place.astype(int), frequency.size - 2)
    row = np.arange(ratio.size)[:, None]
    read = spectrum[row, below] + (place - below) * (spectrum[row, below + 1] - spectrum[row, below])
    read = read / np.mean(read, axis=-1, keepdims=True)
    return np.var(np.mean(read, axis=0)) / np.mean(np.var(read, axis=-1))


def constant_limits(band, beta):
    """Between which values C h(f) = C f^(-beta) maps `band` onto a band that contains it.

    f_2 f_1^beta <= C <= f_1 f_2^beta: Dong et al. 2020, text after eq. 1.
    band : (f_1, f_2), Hz; beta : the assumed waveguide invariant
    Raises ValueError for beta below 1, where no C is left, and for a band that is not (low, high).
    """
    low, high = require_interval("band", require_positive("band", band))
    if not require_positive("beta", beta) >= 1:
        raise ValueError(f"beta must be at least 1, or no constant keeps the band, but {beta:g} was given")
    return high * low**beta, low * high**beta


def warping_constant(band, beta):
    """C = f_0^(1 + beta), with which the operator leaves f_0 in its place: Dong et al. 2020, before eq. 4.

    f_0 is the geometric mean of the band's edges, and C that of its limits. Arguments and errors as for
    `constant_limits`.
    """
    return np.sqrt(np.prod(constant_limits(band, beta)))


def warp(spectrum, frequency, band=BAND, beta=1.0):
    """The warped spectrum |h'(f)|^(1/2) I(h(f)): Dong et al. 2020, eqs. 1-2.

    The new frequencies are those that the operator maps into `band`, where alone I is used.
    spectrum : (..., F), power spectrum; frequency : (F,), Hz, evenly spaced, covering the band
    Returns the new frequencies (N,), Hz, and the warped spectrum (..., N).
    Raises ValueError for a band outside `frequency` and as `warping_constant` does.
    """
    constant = warping_constant(band, beta)
    frequency = require_shape("frequency", require_finite("frequency", frequency), (None,))
    spectrum = require_shape("spectrum", require_finite("spectrum", spectrum), frequency.shape)
    spacing = frequency[1] - frequency[0]
    require_between("band", band, frequency[0] - spacing, frequency[-1] + spacing)
    low, high = (constant / np.array(band[::-1])) ** (1 / beta)
    warped = np.linspace(low, high, int(np.ceil((high - low) / spacing)) + 1)
    source = constant * warped**-beta
    weight = np.sqrt(beta * constant) * warped ** (-(beta + 1) / 2)
    return warped, weight * CubicSpline(frequency, spectrum, axis=-1)(source)


def delay_envelope(warped, frequency, delay):
    """Magnitude of the Fourier transform of the warped spectrum: one pulse for each pair of modes.

    The mean over frequency is removed and a Hann window applied, or the steady part of the spectrum, all the
    |A_n|^2, would cover the pulses.
    warped : (..., N); frequency : (N,), Hz; delay : (D,), s
    Returns (..., D).
    """
    window = np.hanning(frequency.size + 2)[1:-1]
    level = np.sum(window * warped, axis=-1, keepdims=True) / np.sum(window)
    kernel = window[:, None] * np.exp(2j * np.pi * np.outer(frequency - frequency[0], delay))
    tone = warped - level
    return np.hypot(tone @ kernel.real, tone @ kernel.imag) / np.sum(window)


def pulse_delay(waveguide, first, second, distance, beta=1.0, band=BAND):
    """Where to expect the pulse of two modes: tau = beta (t_second - t_first) at f_0, whatever the sea.

    waveguide : PekerisWaveguide; first, second : mode numbers; distance : (...), m
    Returns (...), s. Raises ValueError when a mode is not trapped at f_0.
    """
    centre = warping_constant(band, beta) ** (1 / (1 + beta))
    return beta * group_delay_difference(solve_modes(waveguide, centre), first, second, distance)[..., 0]


def running_mean(values, frames):
    """Mean of `frames` consecutive rows: values (..., K, F) to (..., K - frames + 1, F)."""
    frames = require_whole("frames", frames, 1, values.shape[-2])
    total = np.cumsum(values, axis=-2, dtype=float)
    total[..., frames:, :] -= total[..., :-frames, :].copy()
    return total[..., frames - 1 :, :] / frames


def track_pulse(envelope, delay, start, reach=4e-3):
    """Follow a pulse from frame to frame: the highest point within `reach` of where it last was.

    envelope : (..., K, D); delay : (D,), s, evenly spaced; start : (...), s, where to begin
    reach : s, how far the pulse may move, and how near a neighbour may come, from one frame to the next
    Returns its delay (..., K), s, refined by a parabola. Raises ValueError for a start outside `delay`.
    """
    spacing = delay[1] - delay[0]
    require_between("start", start, delay[0], delay[-1])
    reach = max(int(round(require_positive("reach", reach) / spacing)), 1)
    start = np.rint((np.asarray(start) - delay[0]) / spacing).astype(int)
    position = np.broadcast_to(start, envelope.shape[:-2])[..., None]
    around = np.arange(-reach, reach + 1)
    track = np.empty(envelope.shape[:-1], dtype=int)
    for k in range(envelope.shape[-2]):
        window = np.clip(position + around, 1, delay.size - 2)
        best = np.argmax(np.take_along_axis(envelope[..., k, :], window, axis=-1), axis=-1, keepdims=True)
        position = np.take_along_axis(window, best, axis=-1)
        track[..., k] = position[..., 0]
    return delay[track] + spacing * parabola_offset(envelope, track)


def follow_pulse(spectrum, frequency, delay, start, beta=1.0):
    """From spectra to the delay of one pulse: `warp`, `delay_envelope` and `track_pulse` in a row.

    spectrum : (..., K, F), power; frequency : (F,), Hz; delay : (D,), s, where to look
    start : s, where the pulse is expected at first; beta : the assumed waveguide invariant
    Returns (..., K), s.
    """
    warped_frequency, warped = warp(spectrum, frequency, beta=beta)
    return track_pulse(delay_envelope(warped, warped_frequency, delay), delay, start)


def range_ratio(delay, reference=1):
    """M_k = tau_k / tau_0, the range now over the range at the start: Dong et al. 2020, eqs. 6-9.

    delay : (..., K), s; reference : tau_0 is the mean of that many first delays. More of them make it quieter
    and older: their mean belongs to the middle of those frames, 0.4 % off for 30 of the paper's frames.
    Raises ValueError for delays that are not above 0.
    """
    delay = require_positive("delay", delay)
    reference = require_whole("reference", reference, 1, delay.shape[-1])
    return delay / np.mean(delay[..., :reference], axis=-1, keepdims=True)


def ratio_error(ratio, truth):
    """Mean relative error of the range ratio, mean |M_k / true M_k - 1|: Dong et al. 2020, section 3."""
    return np.mean(np.abs(ratio / truth - 1), axis=-1)
