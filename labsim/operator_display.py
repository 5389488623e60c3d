"""What a human operator of a passive ranging system sees: sweeps of the discriminator, and a range chart.

A machine follows a delay well and is easily led astray; a person sees at a glance which stretches of a
record are worthless. The operator lays a line along the stripe of the display, the machine picks the
exact delays beside it, the operator strikes out what is noise or another vessel, and reads the range on
a chart that is linear in 1 / R. Source: section 5 of the report named in `passive_ranging`.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import binary_dilation

from labsim.arguments import (
    require_finite,
    require_interval,
    require_not_negative,
    require_shape,
    require_whole,
)
from labsim.discriminator import (
    Correlogram,
    Pair,
    correlogram,
    hydrophone_noise,
    read_lags,
    source_signals,
    whole_count,
)

ROOM = 1.2e-3  # s beyond the target's delays that a record holds: almost two periods, for lines that are off
BIN = 1.0  # s, one column of the display
FEWEST = 10  # seconds that a line must rest on
MOST_CHANGE = 0.5  # of the correlation at the picks, against its median, before a second is struck out
MOST_SPREAD = 4.0  # standard deviations off the median: in noise alone, one second in 16,000
GAUSSIAN = 1.4826  # standard deviation over median absolute deviation of Gaussian noise
MARGIN = 3  # seconds struck out on either side of a bad one, which a fade or a crossing spoils in part


@dataclass(frozen=True)
class DisplayScenario:
    """A record with a good beginning, a fade, and a false source crossing; the paper's fig. 7 in numbers.

    pair : the band, and the step at which an automatic tracker may turn its delay lines; whole steps a second
    duration : whole seconds
    fade, false_signal : (start, end), s: no signal; a second source is heard. Either may lie after the record
    false_power : P_U / P_T, not negative
    """

    pair: Pair = field(default_factory=lambda: Pair(step=0.02))
    duration: float = 150.0
    fade: tuple = (45.0, 53.0)
    false_signal: tuple = (95.0, 125.0)
    false_power: float = 2.5

    def __post_init__(self):
        whole_count("a second", BIN, "steps", self.pair.step)
        require_whole("duration", self.duration, low=1)
        require_interval("fade", self.fade, low=0)
        require_interval("false_signal", self.false_signal, low=0)
        require_not_negative("false_power", self.false_power)

    @property
    def time(self):
        """(n,), the time of every sample, s."""
        return np.arange(round(self.duration * self.pair.sample_rate)) / self.pair.sample_rate


@dataclass(frozen=True)
class DisplayRecord:
    """Two pairs of hydrophones, correlated.

    time : (bins,), the middle of every second, s; step_time : (steps,), the middle of every step
    steps : Correlogram of two rows, pairs 1-2 and 2-3, every step, for trackers
    seconds : the same, averaged over every second, for the display
    """

    time: np.ndarray
    step_time: np.ndarray
    steps: Correlogram
    seconds: Correlogram


@dataclass(frozen=True)
class Reading:
    """What an operator made of a record.

    curvature : (bins,), 1 / R second by second, 1/m; keep : (bins,), which of them were used
    line : (bins,), the straight line through those; target_range : m, from that line at the record's middle
    """

    curvature: np.ndarray
    keep: np.ndarray
    line: np.ndarray
    target_range: float


def simulate_record(rng, scenario, target_delays, false_delays):
    """What the hydrophones hear, correlated pair by pair.

    target_delays, false_delays : (2, n), tau12 and tau23 at every sample of `scenario.time`, s
    Returns a DisplayRecord that reaches ROOM beyond the target's delays.
    """
    time, pair = scenario.time, scenario.pair
    audible = pair.signal_power * (1.0 - _within(time, scenario.fade))
    heard = source_signals(rng, pair, _at_hydrophones(target_delays, time), power=audible)
    crossing = _within(time, scenario.false_signal)
    if np.any(crossing):
        false_power = pair.signal_power * scenario.false_power
        delays = _at_hydrophones(false_delays, time)[:, crossing]
        heard[:, :, crossing] += source_signals(rng, pair, delays, power=false_power)
    heard += hydrophone_noise(rng, pair, heard.shape)
    shortest, longest = np.min(target_delays) - ROOM, np.max(target_delays) + ROOM
    steps = correlogram(pair, heard[0, :2], heard[0, 1:], shortest, longest)
    step_time = (np.arange(steps.quadrature.shape[1]) + 0.5) * pair.step
    seconds = Correlogram(steps.lags, _by_second(steps.quadrature, pair), _by_second(steps.in_phase, pair))
    return DisplayRecord((np.arange(seconds.quadrature.shape[1]) + 0.5) * BIN, step_time, steps, seconds)


def straight_line(time, start, end):
    """A manual delay setting that runs from `start` to `end`, s; (bins,)."""
    return start + (end - start) * (time - time[0]) / (time[-1] - time[0])


def sweep(record, lines, offsets):
    """The discriminator display: each second's curve around a manual setting, the paper's fig. 7.

    lines : (2, bins), the setting for either pair, s; offsets : (m,), the saw-tooth sweep around it, s
    Returns (2, bins, m). It falls through zero at the target's delay.
    """
    lines = require_shape("lines", require_finite("lines", lines), (2, record.time.size))
    return read_lags(record.seconds.lags, record.seconds.quadrature, lines[..., None] + np.asarray(offsets))


def nearest_crossing(offsets, curves, limit):
    """The offset nearest to 0 at which each curve falls through zero.

    offsets : (m,), s, increasing; curves : (..., m); limit : s
    Returns (...), linearly interpolated; NaN where no crossing lies within `limit`.
    """
    curves = require_shape("curves", curves, (np.size(offsets),))
    before, after = curves[..., :-1], curves[..., 1:]
    falls = (before > 0) & (after <= 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = offsets[:-1] + (offsets[1:] - offsets[:-1]) * before / (before - after)
    distance = np.where(falls, np.abs(crossing), np.inf)
    nearest = np.argmin(distance, axis=-1)[..., None]
    found = np.take_along_axis(np.where(falls, crossing, np.nan), nearest, -1)[..., 0]
    return np.where(np.abs(found) <= limit, found, np.nan)


def pick_delays(record, lines, offsets, limit):
    """The delays the machine reads beside the operator's lines, (2, bins), s; NaN where it finds none."""
    return lines + nearest_crossing(offsets, sweep(record, lines, offsets), limit)


def kept_seconds(time, *struck_out):
    """Which seconds are left, (bins,), when those inside the intervals (start, end), s, are struck out."""
    keep = np.ones(np.shape(time), dtype=bool)
    for interval in struck_out:
        keep &= ~_within(time, interval)
    return keep


def read_range(time, curvature, keep):
    """A straight line through the kept curvatures, read at the record's middle.

    time, curvature : (bins,), s and 1/m, NaN where there is none; keep : (bins,), bool
    Returns a Reading; its range is infinite where the line is at 0, NaN below. With fewer than FEWEST
    seconds left, line and range are NaN.
    """
    keep = require_shape("keep", keep, (np.size(time),)).astype(bool) & np.isfinite(curvature)
    if np.count_nonzero(keep) < FEWEST:
        return Reading(curvature, keep, np.full(np.shape(time), np.nan), np.nan)
    middle = (time[0] + time[-1]) / 2
    slope, value = np.polyfit(time[keep] - middle, curvature[keep], 1)
    target_range = np.nan if value < 0 else np.inf if value == 0 else 1 / value
    return Reading(curvature, keep, value + slope * (time - middle), target_range)


def trustworthy_seconds(record, picks):
    """A mask as an algorithm would make it: a simulated operator, not a human one.

    Strikes out seconds whose in-phase correlation at the picks is off its median by more than MOST_CHANGE of
    it, or whose difference of delays is off its median by more than MOST_SPREAD robust deviations; and
    MARGIN seconds around each. picks : (2, bins), s. Returns (bins,), bool.
    """
    found = np.all(np.isfinite(picks), axis=0)
    at = np.where(found, picks, 0)[..., None]
    strength = read_lags(record.seconds.lags, record.seconds.in_phase, at)[..., 0]
    relative = strength / np.median(strength, axis=-1, keepdims=True)
    difference = np.where(found, picks[0] - picks[1], np.inf)
    away = np.abs(difference - np.median(difference[found]))
    bad = ~found | np.any(np.abs(relative - 1) > MOST_CHANGE, axis=0)
    bad |= away > MOST_SPREAD * GAUSSIAN * np.median(away[found])
    return ~binary_dilation(bad, iterations=MARGIN)


def _at_hydrophones(delays, time):
    """Arrival times at H1, H2, H3 relative to H2: tau12, 0, -tau23."""
    tau12, tau23 = require_shape("delays", delays, (2, time.size))
    return np.stack([tau12, np.zeros_like(tau12), -tau23])


def _by_second(values, pair):
    rows, _, lags = values.shape
    return values.reshape(rows, -1, round(BIN / pair.step), lags).mean(axis=2)


def _within(time, interval):
    return (time >= interval[0]) & (time < interval[1])
