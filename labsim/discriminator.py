"""How far a delay line is off: the discriminator of two hydrophones, as a curve and as waveforms.

Two hydrophones hear the same band of noise, one a little later. Multiplying one with a filtered copy
of the other, which a delay line holds back by an estimate x0, gives on average an odd function of the
error x = x1 - x0: it says which way to turn the delay line. Source: section 3 of the report named in
`passive_ranging`, called "the paper" here.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.fft import next_fast_len
from scipy.special import sici

from labsim.arguments import (
    require_between,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)
from labsim.noise import TAPS, band_noise, sample_at

READINGS = 200_000


@dataclass(frozen=True)
class Pair:
    """Two hydrophones and the band of noise they hear. The paper names no values; these are ours.

    centre_frequency : f0, Hz; bandwidth : B, Hz, below 2 f0; flat spectra
    signal_power : Ps, not negative; noise_power : Pn at each hydrophone, not negative
    sample_rate : of waveforms, Hz, at least four times the highest frequency
    step : s, time from one reading of the discriminator to the next; a whole number of samples
    """

    centre_frequency: float = 1500.0
    bandwidth: float = 500.0
    signal_power: float = 1.0
    noise_power: float = 1.0
    sample_rate: float = 8000.0
    step: float = 0.004

    def __post_init__(self):
        require_positive("centre_frequency", self.centre_frequency)
        require_between("bandwidth", self.bandwidth, 1e-3, 1.999 * self.centre_frequency)
        require_not_negative("signal_power", self.signal_power)
        require_not_negative("noise_power", self.noise_power)
        require_between("sample_rate", self.sample_rate, 4 * self.band[1], np.inf)
        whole_count("step", self.step, "samples", 1 / self.sample_rate)

    @property
    def band(self):
        """(lowest, highest) frequency, Hz."""
        return self.centre_frequency - self.bandwidth / 2, self.centre_frequency + self.bandwidth / 2

    @property
    def angular_frequency(self):
        """2 pi f0, rad/s."""
        return 2 * np.pi * self.centre_frequency

    @property
    def noise_ratio(self):
        """rho = Pn / Ps; raises ValueError without a signal."""
        return self.noise_power / float(require_positive("signal_power", self.signal_power))

    @property
    def peak(self):
        """The delay error at the discriminator's peak, 1 / (4 f0), s."""
        return 1 / (4 * self.centre_frequency)

    @property
    def cliff(self):
        """The delay error beyond which the discriminator points the wrong way, 1 / (2 f0), s."""
        return 1 / (2 * self.centre_frequency)

    @property
    def samples_per_step(self):
        """Samples in one step."""
        return round(self.step * self.sample_rate)


@dataclass(frozen=True)
class Correlogram:
    """Waveforms boiled down to what a delay line can ask of them.

    lags : (lags,), s, evenly spaced
    quadrature : (trials, steps, lags), mean over each step of y1(t) (h * y2)(t - lag): the paper's D
    in_phase : (trials, steps, lags), the same without the filter h; large where the delay is right
    """

    lags: np.ndarray
    quadrature: np.ndarray
    in_phase: np.ndarray


def whole_count(name, duration, parts, length):
    """How many `parts`, such as "samples", of `length` s the `duration` called `name` holds, s.

    Raises ValueError unless they are a whole number.
    """
    count = float(require_positive(name, duration) / length)
    if abs(count - round(count)) > 1e-6 * count:
        raise ValueError(f"{name} must be a whole number of {parts}, but {duration:g} s is {count:g}")
    return round(count)


def sign_filter(frequency, centre_frequency):
    """Spectrum of the weight U(u) = sign(u) for |u| < 1 / (2 f0): a filter that turns phases by 90 degrees.

    frequency : (...), Hz. Returns (...), complex, s: -2j (1 - cos(pi f / f0)) / (2 pi f).
    """
    frequency = np.asarray(frequency, dtype=float)
    turn = np.pi * frequency / centre_frequency
    return -1j * np.divide(1 - np.cos(turn), np.pi * frequency, out=np.zeros_like(turn), where=frequency != 0)


def discriminator_curve(pair, error):
    """Mean of the discriminator at a delay error, exactly: the spectrum times `sign_filter`, transformed.

    d(x) = (Ps / B) times the integral over the band of (1 - cos(pi f / f0)) sin(2 pi f x) / (pi f)
    error : (...), x = x1 - x0, s. Returns (...), in units of power times s.
    """
    low, high = (2 * np.pi * edge for edge in pair.band)
    error, shift = require_finite("error", error), pair.cliff

    def integral(delay):
        return sici(high * delay)[0] - sici(low * delay)[0]

    whole = integral(error) - (integral(error + shift) + integral(error - shift)) / 2
    return pair.signal_power / (np.pi * pair.bandwidth) * whole


def sinusoidal_curve(pair, error):
    """The discriminator's curve for a narrow band: (4 / w) Ps sin(w x), w = 2 pi f0.

    The paper's eq. 3.3, 4 Ps x, is its tangent. error : (...), s.
    """
    return 4 * pair.signal_power * np.sin(pair.angular_frequency * np.asarray(error)) / pair.angular_frequency


def curve_slope(pair):
    """Slope of `discriminator_curve` at zero error: 2 Ps (1 + sinc(B / (2 f0))), a little below 4 Ps."""
    return 2 * pair.signal_power * (1 + np.sinc(pair.bandwidth / (2 * pair.centre_frequency)))


def noise_density(pair, error=0.0):
    """Density of the discriminator's noise at low frequencies, the paper's eqs. 3.4-3.5, mended.

    N = 2 / (pi² f0² B) (Pn² + 2 Ps Pn + 2 Ps² sin²(w x)), two-sided, per Hz
    error : (...), s. Returns (...).
    Mended: the paper has 2 Ps² at any error. With both channels alike the product of a signal and its
    own quadrature does not fluctuate slowly at all, so at x = 0 that term is zero; the paper's value is
    right only at the peak of the curve. Without noise an aligned discriminator is silent.
    """
    turned = np.sin(pair.angular_frequency * np.asarray(error)) ** 2
    own = pair.noise_power**2 + 2 * pair.signal_power * pair.noise_power
    return _noise_scale(pair) * (own + 2 * pair.signal_power**2 * turned)


def noise_density_as_printed(pair):
    """The paper's eq. 3.5: 2 / (pi² f0² B) (2 Ps² + 2 Ps Pn + Pn²); see `noise_density`."""
    signal, noise = pair.signal_power, pair.noise_power
    return _noise_scale(pair) * (2 * signal**2 + 2 * signal * noise + noise**2)


def source_signals(rng, pair, delays, trials=1, power=1.0):
    """One source heard by several hydrophones, each with its own delay that may change with time.

    rng : numpy.random.Generator; pair : its band and sample rate
    delays : (hydrophones, n), s, at every sample
    power : number or (n,), not negative; a fade is a stretch of zeros
    Returns (trials, hydrophones, n).
    """
    delays = require_shape("delays", require_finite("delays", delays), (None, None))
    if delays.ndim != 2:
        raise ValueError(f"delays must have shape (hydrophones, n), but {delays.shape} was given")
    samples = delays.shape[-1]
    amplitude = np.sqrt(require_not_negative("power", power))
    if amplitude.ndim and amplitude.shape != (samples,):
        raise ValueError(f"power must be a number or have shape ({samples},), not {amplitude.shape}")
    margin = int(np.ceil(np.max(np.abs(delays)) * pair.sample_rate)) + TAPS
    signal = band_noise(rng, (trials, next_fast_len(samples + 2 * margin)), pair.band, pair.sample_rate)
    heard = np.empty((trials, *delays.shape))
    for hydrophone, delay in enumerate(delays):
        if np.any(delay):
            time = (np.arange(samples) + margin) / pair.sample_rate - delay
            reading = _read_in_parts(signal, pair.sample_rate, time)
        else:
            reading = signal[:, margin : margin + samples]
        heard[:, hydrophone] = amplitude * reading
    return heard


def hydrophone_noise(rng, pair, shape):
    """Noise of power Pn in the pair's band, independent in every row; the last axis of `shape` is time."""
    *batch, samples = shape
    noise = band_noise(rng, (*batch, next_fast_len(samples)), pair.band, pair.sample_rate)
    return np.sqrt(pair.noise_power) * noise[..., :samples]


def two_channel_waveforms(rng, pair, delay, trials=1, power=1.0):
    """What the two hydrophones record: y1 = s(t - x1(t)) + n1, y2 = s(t) + n2.

    delay : (n,), x1 at every sample, s; power : number or (n,), multiplies the pair's signal power
    Returns y1, y2, each (trials, n).
    """
    delay = require_shape("delay", delay, (None,))
    delays = np.stack([delay, np.zeros_like(delay)])
    heard = source_signals(rng, pair, delays, trials, pair.signal_power * np.asarray(power))
    heard += hydrophone_noise(rng, pair, heard.shape)
    return heard[:, 0], heard[:, 1]


def correlogram(pair, y1, y2, shortest, longest):
    """The discriminator of two waveforms, the paper's eq. 3.1, at every lag of a grid of whole samples.

    y1, y2 : (trials, n); shortest, longest : lags wanted, s
    Returns a Correlogram of the pair's whole steps in n. It reaches 6 samples beyond the lags wanted.
    Raises ValueError for waveforms that differ in shape or are shorter than a step.
    """
    y1 = require_shape("y1", y1, (None, None))
    y2 = require_shape("y2", y2, y1.shape[-2:])
    length = pair.samples_per_step
    steps = y1.shape[-1] // length
    if steps < 1 or longest < shortest:
        raise ValueError(
            f"waveforms must hold a step of {length} samples and lags from shortest to longest, "
            f"but {y1.shape[-1]} samples and {shortest:g} to {longest:g} s were given"
        )
    filtered = _turned(pair, y2)
    first = int(np.floor(shortest * pair.sample_rate)) - TAPS // 2
    last = int(np.ceil(longest * pair.sample_rate)) + TAPS // 2
    whole = np.arange(first, last + 1)
    quadrature, in_phase = (_lagged_means(y1, other, whole, length) for other in (filtered, y2))
    return Correlogram(whole / pair.sample_rate, quadrature, in_phase)


def read_lags(lags, values, delay):
    """Read curves given on a grid of lags at any delay between them.

    lags : (lags,), s; values : (..., lags); delay : (..., m), s
    Returns (..., m). Beyond the lags the nearest delay that can be read is taken.
    """
    rate = (lags.size - 1) / (lags[-1] - lags[0])
    edge = (TAPS // 2) / rate
    inside = np.clip(np.asarray(delay) - lags[0], edge, lags[-1] - lags[0] - edge)
    return sample_at(values, rate, inside)


@dataclass(frozen=True)
class WaveformObserver:
    """A delay line's view of recorded waveforms: reads a Correlogram at its own delay, step by step."""

    correlogram: Correlogram

    @property
    def shape(self):
        """(steps, trials)."""
        trials, steps, _ = self.correlogram.quadrature.shape
        return steps, trials

    def error_signal(self, k, delay):
        """The discriminator D in step k with the delay lines at `delay` (trials,), s."""
        return self._read(self.correlogram.quadrature[:, k], delay)

    def in_phase(self, k, delay):
        """The plain correlation in step k with the delay lines at `delay` (trials,), s."""
        return self._read(self.correlogram.in_phase[:, k], delay)

    def _read(self, values, delay):
        return read_lags(self.correlogram.lags, values, delay[:, None])[:, 0]


class _Baseband:
    """What the models without waveforms share: the size of a batch, and the scales of curve and noise."""

    pair: Pair
    noise: np.ndarray

    @property
    def shape(self):
        """(steps, trials)."""
        return self.noise.shape[1:]

    @cached_property
    def _scales(self):
        """Height of a sine of the true slope, for a power of 1, and deviation of the noise in one step."""
        slope = curve_slope(replace(self.pair, signal_power=1.0))
        return slope / self.pair.angular_frequency, np.sqrt(_noise_scale(self.pair) / self.pair.step)


@dataclass(frozen=True)
class BasebandObserver(_Baseband):
    """The same view without waveforms: a sine of the true slope plus white noise of the mended density.

    The sine is within 3 % of the curve's peak for errors as far as the cliff.

    pair : Pair; delay : (steps,) or (steps, trials), x1 in the middle of each step, s
    noise : (2, steps, trials), independent normal numbers for the error signal and the in-phase reading;
        (1, steps, trials) will do for a loop that reads the error signal alone
    power : number, (steps,) or (steps, trials), multiplies the pair's signal power
    """

    pair: Pair
    delay: np.ndarray
    noise: np.ndarray
    power: np.ndarray = 1.0

    def __post_init__(self):
        _, steps, trials = require_shape("noise", self.noise, (None, None, None)).shape
        for name, value in (("delay", self.delay), ("power", self.power)):
            if np.shape(value) not in ((), (steps,), (steps, 1), (steps, trials)):
                raise ValueError(f"{name} must fit {steps} steps of {trials} trials, not {np.shape(value)}")
        require_not_negative("power", self.power)

    def error_signal(self, k, delay):
        """As `WaveformObserver.error_signal`."""
        pair, signal = self.pair, self._signal_power(k)
        sine = signal * np.sin(pair.angular_frequency * (self.delay[k] - delay))
        spread = pair.noise_power * (pair.noise_power + 2 * signal) + 2 * sine**2
        height, scale = self._scales
        return height * sine + scale * np.sqrt(spread) * self.noise[0, k]

    def in_phase(self, k, delay):
        """As `WaveformObserver.in_phase`; raises ValueError without a second row of noise."""
        if len(self.noise) < 2:
            raise ValueError("noise must have 2 rows for the in-phase reading, but 1 was given")
        pair, signal = self.pair, self._signal_power(k)
        cosine = np.cos(pair.angular_frequency * (self.delay[k] - delay))
        spread = pair.noise_power * (pair.noise_power + 2 * signal) + 2 * (signal * cosine) ** 2
        return signal * cosine + np.sqrt(spread / (2 * pair.bandwidth * pair.step)) * self.noise[1, k]

    def _signal_power(self, k):
        power = self.power if np.ndim(self.power) == 0 else self.power[k]
        return self.pair.signal_power * power


@dataclass(frozen=True)
class TwoSourceObserver(_Baseband):
    """A BasebandObserver that hears a second source in the same band.

    That source may be periods away, where the width of the band counts: here every sine has the envelope
    sinc(B x), which a BasebandObserver leaves out.

    pair : Pair; delay, false_delay : (steps,), of the target and of the false source, s
    false_power : (steps,) or a number, P_U / P_T; noise : as of BasebandObserver
    """

    pair: Pair
    delay: np.ndarray
    false_delay: np.ndarray
    false_power: float
    noise: np.ndarray

    def __post_init__(self):
        steps = require_shape("noise", self.noise, (2, None, None)).shape[1]
        require_shape("delay", self.delay, (steps,))
        require_shape("false_delay", self.false_delay, (steps,))
        require_not_negative("false_power", self.false_power)

    def error_signal(self, k, delay):
        """As `WaveformObserver.error_signal`."""
        coherence, power = self._coherence(k, delay)
        height, scale = self._scales
        spread = scale * np.sqrt(power**2 - np.real(coherence**2))
        return height * coherence.imag + spread * self.noise[0, k]

    def in_phase(self, k, delay):
        """As `WaveformObserver.in_phase`."""
        coherence, power = self._coherence(k, delay)
        spread = np.sqrt((power**2 + np.real(coherence**2)) / (2 * self.pair.bandwidth * self.pair.step))
        return coherence.real + spread * self.noise[1, k]

    def _coherence(self, k, delay):
        false_power = np.broadcast_to(self.false_power, self.delay.shape)[k]
        power = self.pair.signal_power * np.array([1.0, false_power])
        error = np.array([self.delay[k], self.false_delay[k]])[:, None] - delay
        turned = np.exp(1j * self.pair.angular_frequency * error) * np.sinc(self.pair.bandwidth * error)
        return power @ turned, np.sum(power) + self.pair.noise_power


def _noise_scale(pair):
    return 2 / (np.pi**2 * pair.centre_frequency**2 * pair.bandwidth)


def _read_in_parts(signal, sample_rate, time):
    """`sample_at` for (trials, n) signals at the same times (m,), some at a time to spare memory."""
    result = np.empty((len(signal), time.size))
    length = max(1, READINGS // len(signal))
    for first in range(0, time.size, length):
        part = np.broadcast_to(time[first : first + length], (len(signal), time[first : first + length].size))
        result[:, first : first + length] = sample_at(signal, sample_rate, part)
    return result


def _turned(pair, waveform):
    samples = waveform.shape[-1]
    frequency = np.fft.rfftfreq(samples, 1 / pair.sample_rate)
    return np.fft.irfft(np.fft.rfft(waveform) * sign_filter(frequency, pair.centre_frequency), samples)


def _lagged_means(fixed, shifted, lags, length):
    """Means over steps of `length` samples of fixed(t) shifted(t - lag), (trials, steps, lags)."""
    trials, samples = fixed.shape
    steps = samples // length
    whole = steps * length
    reach = int(np.max(np.abs(lags)))
    padded = np.pad(shifted, ((0, 0), (reach, reach)))
    blocks = fixed[:, :whole].reshape(trials, steps, length)
    result = np.empty((trials, steps, lags.size))
    for column, lag in enumerate(lags):
        other = padded[:, reach - lag : reach - lag + whole].reshape(trials, steps, length)
        result[:, :, column] = np.einsum("tsl,tsl->ts", blocks, other) / length
    return result
