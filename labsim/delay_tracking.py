"""Loops that hold on to a delay: simple, with a Kalman filter, with automatic gain, through fades.

The discriminator says which way the delay line is off; a loop turns the line that way. How hard it
turns is its one knob: a hard turn follows every noise, a soft one lags behind a moving target. Source:
section 4 of the report named in `passive_ranging`, called "the paper" here.
"""

from dataclasses import dataclass

import numpy as np

from labsim.arguments import (
    require_between,
    require_choice,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)
from labsim.discriminator import noise_density, noise_density_as_printed, whole_count

FORMS = ("scalar", "diagonal", "rank one")
START = np.diag([20e-6, 50e-6]) ** 2


@dataclass(frozen=True)
class Loop:
    """A delay-tracking loop, the paper's fig. 4.

    time_constant : T, s, above 0, at the pair's own signal power
    memory : s, above 0; the rate of the delay line is learned with this time constant and kept; the
        default, infinite, is the simple loop that learns no rate
    smoothing : s, above 0; time constant of the signal power that sets an automatic gain
    most_gain : at most so many times the gain of `time_constant` is taken by an automatic gain, above 0
    """

    time_constant: float = 0.3
    memory: float = np.inf
    smoothing: float = 0.5
    most_gain: float = 3.0

    def __post_init__(self):
        require_positive("time_constant", self.time_constant)
        if not self.memory > 0:
            raise ValueError(f"memory must be above 0, but {self.memory:g} was given")
        require_positive("smoothing", self.smoothing)
        require_positive("most_gain", self.most_gain)


@dataclass(frozen=True)
class KalmanTracker:
    """The paper's Kalman filter for delay and rate, eqs. 4.9-4.18.

    interval : Dt, s, above 0, a whole number of the pair's steps
    intensity : of the process noise, q: the density of the target's white acceleration, s²/s³, not negative
    form : what the filter believes it measures in an interval: "scalar", the mean error, once; "diagonal"
        and "rank one", the paper's pair of error y and rate 2 y / Dt, as if independent or as they are
    """

    interval: float = 0.1
    intensity: float = 1e-10
    form: str = "scalar"

    def __post_init__(self):
        require_positive("interval", self.interval)
        require_not_negative("intensity", self.intensity)
        require_choice("form", self.form, FORMS)

    @property
    def transition(self):
        """F, (2, 2): delay and rate one interval later."""
        return np.array([[1.0, self.interval], [0.0, 1.0]])

    @property
    def process_noise(self):
        """Q, (2, 2): what the white acceleration adds in one interval."""
        t = self.interval
        return self.intensity * np.array([[t**3 / 3, t**2 / 2], [t**2 / 2, t]])


def loop_gain(pair, time_constant):
    """G = 1 / (4 Ps T), the paper's eq. 4.2, per power and s²."""
    power = require_positive("signal_power", pair.signal_power)
    return 1 / (4 * power * require_positive("time_constant", time_constant))


def loop_constant(pair):
    """K, the variance of the delay times T, s³: the paper's eq. 4.4, mended.

    K = N / (32 Ps²) = (2 rho + rho²) / (16 pi² f0² B): a loop of gain G = 1 / (4 Ps T) makes of noise
    with the density N, `discriminator.noise_density` at zero error, the variance G² N T / 2.
    Mended: the paper has 2 + 2 rho + rho², because its N keeps 2 Ps² where the discriminator is silent.
    So mended, K / T is the Cramér-Rao bound of a narrow band observed for 2 T: no loop can do better.
    """
    return noise_density(pair) / (32 * require_positive("signal_power", pair.signal_power) ** 2)


def loop_constant_as_printed(pair):
    """The paper's eq. 4.4: K = (2 + 2 rho + rho²) / (16 pi² f0² B); see `loop_constant`."""
    return noise_density_as_printed(pair) / (32 * require_positive("signal_power", pair.signal_power) ** 2)


def delay_jitter(constant, time_constant):
    """Standard deviation of the tracked delay, the paper's eq. 4.3: sqrt(K / T), s.

    constant : K, s³; time_constant : T (...), s. A loop that turns in steps jitters by a little more:
    its variance is K / (T - step / 2).
    """
    return np.sqrt(require_not_negative("K", constant) / require_positive("time_constant", time_constant))


def ramp_lag(rate, time_constant):
    """How far the loop runs behind a delay that grows steadily, the paper's eq. 4.5: rate times T, s."""
    return np.asarray(rate) * require_positive("time_constant", time_constant)


def step_response(pair, error, time_constant, time):
    """The error left at `time` (...), s, after a jump of the delay by `error`, s.

    tan(w e / 2) = tan(w e0 / 2) exp(-t / T), from the discriminator's sine.
    Raises ValueError for a jump of 1 / (2 f0) or more, from which the loop goes elsewhere.
    """
    if np.any(np.abs(require_finite("error", error)) >= pair.cliff):
        raise ValueError(f"error must stay within {pair.cliff:g} s of 0, the discriminator's cliff")
    half = np.tan(pair.angular_frequency * np.asarray(error) / 2)
    decay = np.exp(-np.asarray(time) / require_positive("time_constant", time_constant))
    return 2 / pair.angular_frequency * np.arctan(half * decay)


def total_error(constant, time_constant, rate):
    """The paper's measure of a loop, eq. 4.6: lag plus three standard deviations, s.

    constant : K, s³; time_constant : T (...), s; rate : of the delay, not followed by any aiding, s/s
    """
    return np.abs(ramp_lag(rate, time_constant)) + 3 * delay_jitter(constant, time_constant)


def best_time_constant(constant, rate):
    """The T of least total error, the paper's eq. 4.8: (9 K / (4 rate²))^(1/3), s; infinite at rest."""
    with np.errstate(divide="ignore"):
        return np.cbrt(9 * require_not_negative("K", constant) / (4 * np.square(rate)))


def least_total_error(constant, rate):
    """The least total error, the paper's eq. 4.7: 3 (9 K rate / 4)^(1/3), s. One third of it is lag."""
    return 3 * np.cbrt(9 / 4 * require_not_negative("K", constant) * np.abs(rate))


def track(observer, pair, loop, start=0.0, aiding=0.0):
    """Run the loop, eq. 4.1: dx0/dt = G D + aiding + the rate it has learned. All trials at once.

    observer : WaveformObserver, BasebandObserver or TwoSourceObserver of (steps, trials)
    start : delay at the beginning, (trials,) or a number, s
    aiding : (steps,) or a number, a rate known from elsewhere, say from a gyro, s/s
    Returns (steps, trials), the delay in each step, s.
    Raises ValueError for a time constant so short for the step that the loop is unstable.
    """
    _require_stable(pair, loop, 1.0)
    steps, trials = observer.shape
    aiding = np.broadcast_to(require_finite("aiding", aiding), steps)
    gain = loop_gain(pair, loop.time_constant)
    delay, rate = np.full(trials, start, dtype=float), np.zeros(trials)
    estimate = np.empty((steps, trials))
    for k in range(steps):
        estimate[k] = delay
        turn = gain * observer.error_signal(k, delay)
        rate += pair.step / loop.memory * turn
        delay += pair.step * (turn + rate + aiding[k])
    return estimate


def track_with_gain_control(observer, pair, loop, start=0.0, rate=0.0):
    """The paper's practical loop, eq. 4.19: the gain follows the signal power, G = C Ps / Pn.

    Ps is read from the in-phase correlation, smoothed with `loop.smoothing`. C makes the time constant
    `loop.time_constant` at the pair's signal power. A fade closes the gain and the line coasts on at its
    learned rate; so does an error beyond 1 / (4 f0), where the correlation is negative.
    start, rate : delay and learned rate at the beginning, (trials,) or numbers, s and s/s
    Else as `track`. The paper's formula is badly legible; this is its plain part.
    """
    _require_stable(pair, loop, loop.most_gain)
    steps, trials = observer.shape
    design = loop_gain(pair, loop.time_constant)
    delay, rate = np.full(trials, start, dtype=float), np.full(trials, rate, dtype=float)
    level = np.ones(trials)
    estimate = np.empty((steps, trials))
    for k in range(steps):
        estimate[k] = delay
        relative = observer.in_phase(k, delay) / pair.signal_power
        level += pair.step / loop.smoothing * (relative - level)
        turn = design * np.clip(level, 0, loop.most_gain) * observer.error_signal(k, delay)
        rate += pair.step / loop.memory * turn
        delay += pair.step * (turn + rate)
    return estimate


def measurement_model(pair, tracker):
    """What a KalmanTracker believes of its measurement: H (m, 2) and R (m, m), m = 1 or 2.

    The mean error y over an interval is the error at its end less half an interval of rate error, so
    H = (1, -Dt / 2), and its variance is 2 K / Dt. The paper's pair (y, 2 y / Dt) holds no second number:
    its R has rank one, and a filter that is told so trusts 2 y / Dt - rate without any noise.
    """
    interval = tracker.interval
    variance = 2 * loop_constant(pair) / interval
    if tracker.form == "scalar":
        return np.array([[1.0, -interval / 2]]), np.array([[variance]])
    ratio = np.array([1.0, 2 / interval])
    noise = variance * np.outer(ratio, ratio)
    return np.eye(2), noise if tracker.form == "rank one" else np.diag(np.diag(noise))


def kalman_gains(pair, tracker, intervals, covariance=None):
    """The filter's gains and covariances, eqs. 4.15-4.18; they depend on no measurement.

    covariance : (2, 2), C before the first interval; by default (20 us)² and (50 us/s)²
    Returns gains (intervals, 2, m) and covariances C (intervals, 2, 2).
    """
    model, noise = measurement_model(pair, tracker)
    covariance = START if covariance is None else require_shape("covariance", covariance, (2, 2))
    gains, covariances = np.empty((intervals, 2, len(model))), np.empty((intervals, 2, 2))
    for k in range(intervals):
        predicted = tracker.transition @ covariance @ tracker.transition.T + tracker.process_noise
        gains[k] = predicted @ model.T @ np.linalg.inv(model @ predicted @ model.T + noise)
        covariance = (np.eye(2) - gains[k] @ model) @ predicted
        covariances[k] = covariance
    return gains, covariances


def track_kalman(observer, pair, tracker, start=0.0, rate=0.0, covariance=None):
    """Run the Kalman tracker, eqs. 4.11-4.14: within an interval the delay line follows the predicted rate.

    start, rate : at the beginning, (trials,) or numbers, s and s/s; covariance : as in `kalman_gains`
    Returns (intervals, trials, 2): delay, s, and rate, s/s, at the end of each interval.
    Raises ValueError for an interval that is no whole number of steps.
    """
    steps, trials = observer.shape
    per_interval = whole_count("interval", tracker.interval, "steps", pair.step)
    gains, _ = kalman_gains(pair, tracker, steps // per_interval, covariance)
    measured = np.array([1.0, 2 / tracker.interval])[: gains.shape[2]]
    middle = (np.arange(per_interval) + 0.5) * pair.step
    state = np.stack([np.full(trials, start, dtype=float), np.full(trials, rate, dtype=float)])
    estimate = np.empty((len(gains), trials, 2))
    for k, gain in enumerate(gains):
        first = k * per_interval
        signals = [observer.error_signal(first + j, state[0] + state[1] * t) for j, t in enumerate(middle)]
        error = np.mean(signals, axis=0) / (4 * pair.signal_power)
        state = tracker.transition @ state + (gain @ measured)[:, None] * error
        estimate[k] = state.T
    return estimate


def maximum_fade(pair, rate, acceleration=0.0):
    """The longest fade a coasting delay line survives, the paper's eq. 4.20, s.

    1 / (4 f0 |v|) (1 - a / (8 f0 v²)): the time in which a rate v the line does not know, and an
    acceleration a, add up to 1 / (4 f0), to first order in a.
    rate : (...), s/s, not 0; acceleration : (...), s/s², its sign counted along the rate's
    Nonsense for |a| above 8 f0 v², negative for a above it; `maximum_fade_exactly` is the root itself.
    """
    rate = np.abs(_require_moving(rate))
    slow = 8 * pair.centre_frequency * rate**2
    return pair.peak / rate * (1 - np.asarray(acceleration) / slow)


def maximum_fade_exactly(pair, rate, acceleration=0.0):
    """First time at which |v t + a t² / 2| reaches 1 / (4 f0), s; arguments as of `maximum_fade`."""
    rate, acceleration = np.abs(_require_moving(rate)), require_finite("acceleration", acceleration)
    limit = pair.peak
    with np.errstate(invalid="ignore", divide="ignore"):
        towards = 2 * limit / (rate + np.sqrt(rate**2 + 2 * acceleration * limit))
        back = (rate + np.sqrt(rate**2 - 2 * acceleration * limit)) / -acceleration
    return np.where(np.isnan(towards), back, towards)


def gyro_rate(spacing, mean_delay, turn_rate, sound_speed=1500.0):
    """Rate of the delay that the array's own turning causes, the paper's eq. 4.21, s/s.

    -(1 / c) sqrt(a² - c² x²) times the turn rate (a stray a in the print is left out).
    spacing : a, m; mean_delay : x (...), s; turn_rate : (...), rad/s
    Raises ValueError for a delay longer than a / c.
    """
    longest = require_positive("spacing", spacing) / require_positive("sound_speed", sound_speed)
    mean_delay = require_between("mean_delay", mean_delay, -longest, longest)
    return -np.sqrt(longest**2 - mean_delay**2) * np.asarray(turn_rate)


def lost(pair, error):
    """Loss of lock: whether a delay error (...), s, is beyond 1 / (4 f0), on another fringe or on none."""
    return np.abs(error) > pair.peak


def _require_stable(pair, loop, most_gain):
    turn = most_gain * pair.step / loop.time_constant
    if 2 * turn + turn * pair.step / loop.memory >= 4:
        raise ValueError(
            f"time_constant must be longer than {most_gain * pair.step / 2:g} s or the loop is unstable, "
            f"but {loop.time_constant:g} was given"
        )


def _require_moving(rate):
    rate = require_finite("rate", rate)
    if np.any(rate == 0):
        raise ValueError("rate must not be 0: a delay line at rest survives any fade")
    return rate
