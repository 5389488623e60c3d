"""Band-limited Gaussian noise, decibels, and reading a band-limited signal between its samples.

Broadband ship noise is modelled, here and in the papers, as a Gaussian process with a flat
spectrum inside a band. Such a signal is known everywhere once it is known at its samples, so a
moving source is heard by reading it at the times at which the sound left.
"""

from functools import cache

import numpy as np

from labsim.arguments import require_finite, require_interval, require_positive, require_shape

TAPS = 12
KAISER_BETA = 9.5
PHASES = 1024
CHUNK = 8192


def decibels(power_ratio):
    """10 log10 of a power ratio."""
    return 10 * np.log10(power_ratio)


def power_ratio(level_db):
    """The power ratio of a level in decibels."""
    return 10 ** (np.asarray(level_db, dtype=float) / 10)


def band_noise(rng, shape, band, sample_rate):
    """Gaussian noise of unit variance with a flat spectrum inside `band` and nothing outside.

    rng : numpy.random.Generator
    shape : int or tuple; the last axis is time
    band : (low, high), Hz
    sample_rate : Hz
    Returns an array of that shape. It is periodic with the length of the record.
    Raises ValueError for a band outside 0 to sample_rate / 2 or narrower than one frequency bin.
    """
    low, high = require_interval("band", band, 0, sample_rate / 2)
    *batch, samples = np.atleast_1d(shape)
    frequency = np.fft.rfftfreq(samples, 1 / sample_rate)
    inside = (frequency >= low) & (frequency <= high) & (frequency > 0) & (frequency < sample_rate / 2)
    bins = np.count_nonzero(inside)
    if bins == 0:
        raise ValueError(
            f"band must be wider than {sample_rate / samples:g} Hz, but ({low:g}, {high:g}) was given"
        )
    spectrum = np.zeros((*batch, frequency.size), dtype=complex)
    real, imaginary = rng.standard_normal((2, *batch, bins))
    spectrum[..., inside] = (real + 1j * imaginary) * samples / (2 * np.sqrt(bins))
    return np.fft.irfft(spectrum, samples, axis=-1)


def sample_at(signal, sample_rate, time):
    """Read a band-limited signal at any times, by a Kaiser-windowed sinc of 12 taps.

    signal : (n,), or (..., n) for a batch, sampled at 0, 1/sample_rate, 2/sample_rate, ...
    sample_rate : Hz
    time : s; any shape for one signal, (..., m) with the batch's leading axes for a batch;
        at least 6 samples away from both ends of the signal
    Returns the shape of `time`. The error is below -85 dB for frequencies up to 0.25 of `sample_rate`, and
    grows to -60 dB at 0.27.
    Raises ValueError for times outside the signal, or leading axes that do not match.
    """
    signal = require_shape("signal", signal, (None,))
    *batch, length = signal.shape
    time = require_shape("time", require_finite("time", time), (*batch, None) if batch else ())
    position = time * require_positive("sample_rate", sample_rate)
    first = np.floor(position).astype(int) - TAPS // 2 + 1
    if first.size and (first.min() < 0 or first.max() + TAPS > length):
        raise ValueError(
            f"time must lie between {(TAPS // 2 - 1) / sample_rate:g} and "
            f"{(length - TAPS // 2 - 1) / sample_rate:g} s, "
            f"but {np.min(time):g} to {np.max(time):g} was given"
        )
    row = np.arange(int(np.prod(batch))).reshape(*batch, 1) * length if batch else 0
    return _weighted_sum(signal.ravel(), first + row, position - np.floor(position))


def _weighted_sum(signal, first, fraction):
    """Sum of the 12 samples from `first` on, weighted by the kernel for a place `fraction` of a sample on.

    The kernel is looked up in a table of PHASES fractions, linearly interpolated (error below -120 dB).
    """
    weights, steps = _kernel_table()
    taps = np.arange(TAPS)[:, None]
    result = np.empty(first.size)
    places, fraction = first.ravel(), fraction.ravel() * PHASES
    for start in range(0, first.size, CHUNK):
        part = slice(start, start + CHUNK)
        phase = fraction[part].astype(int)
        kernel = weights.take(phase, axis=1) + (fraction[part] - phase) * steps.take(phase, axis=1)
        result[part] = np.sum(signal.take(places[part] + taps) * kernel, axis=0)
    return result.reshape(first.shape)


@cache
def _kernel_table():
    weights = _kernel(np.linspace(0, 1, PHASES + 1) + TAPS // 2 - 1 - np.arange(TAPS)[:, None])
    return weights, np.diff(weights, append=0)


def _kernel(offset):
    window = np.i0(KAISER_BETA * np.sqrt(np.clip(1 - (2 * offset / TAPS) ** 2, 0, 1))) / np.i0(KAISER_BETA)
    return np.sinc(offset) * window
