"""What one vector sensor hears from a passing vessel, and the direction it makes of it.

A vector sensor measures sound pressure and the three components of particle velocity at one point;
their averaged product, the sound intensity, points along the path of the sound. The signal model, the
estimator and the scenario are those of Wu & Hu, Technical Acoustics 29(4):361-364, 2010; the error
laws, the Cramer-Rao bound and the maximum-likelihood direction are derived here for the same model.

The sensor is the origin, z points up to the surface, the vessel moves in the plane z = sensor_depth.
Azimuth runs from x towards y, the other angle from the vertical. The unit vector a points from the
sensor to the source, and particle velocity is scaled by rho c and counted positive along a.
"""

import struct
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.fft import next_fast_len
from scipy.interpolate import PPoly
from scipy.io import wavfile

from labsim.arguments import (
    require_choice,
    require_finite,
    require_interval,
    require_positive,
    require_scalar,
    require_shape,
    require_whole,
)
from labsim.metrics import angle_difference
from labsim.motion import Track, retarded_time, straight_track
from labsim.noise import band_noise, decibels, power_ratio, sample_at

CHANNEL_ORDERS = {
    "pxyz": ((0, 1, 2, 3), 1.0),
    "fuma": ((0, 1, 2, 3), np.sqrt(2)),
    "sn3d": ((0, 3, 1, 2), 1.0),
}
BLOCKS = 5


@dataclass(frozen=True)
class PassingVessel:
    """A vessel passing one vector sensor; the defaults are those of Wu & Hu 2010, section 3.

    sensor_depth : m; start : position at time 0, m; speed : m/s, 0 for a source at rest
    heading : direction of motion, radians from the x axis; sound_speed : m/s
    sample_rate : Hz; duration : of the record, s; window : averaging time T, s
    band : of the source and of the noise, Hz
    snr_db : in-band signal-to-noise ratio of the pressure at the closest point of the record, dB
        (not stated in the paper; about 10 to 18 dB would fit what it says of its figures)
    velocity_noise_ratio : noise power of one velocity channel over that of pressure, Nv / Np
    track : a labsim.motion.Track that replaces start, speed and heading
    """

    sensor_depth: float = 100.0
    start: tuple[float, float] = (-250.0, 100.0)
    speed: float = 12.0
    heading: float = np.pi / 18
    sound_speed: float = 1500.0
    sample_rate: float = 6000.0
    duration: float = 60.0
    window: float = 0.5
    band: tuple[float, float] = (200.0, 800.0)
    snr_db: float = 14.0
    velocity_noise_ratio: float = 1.0
    track: Track | None = None

    def __post_init__(self):
        above_0 = ("sensor_depth", "sound_speed", "sample_rate", "duration", "window", "velocity_noise_ratio")
        for name in above_0:
            require_positive(name, getattr(self, name))
        for name in (*above_0, "snr_db", "heading", "speed"):
            require_scalar(name, getattr(self, name))
        require_shape("start", require_finite("start", self.start), (2,))
        require_interval("band", self.band, 0, self.sample_rate / 2)
        if not 0 <= self.speed < self.sound_speed:
            raise ValueError(
                f"speed must lie from 0 to below {self.sound_speed:g} m/s, but {self.speed:g} was given"
            )
        if not 1 / self.sample_rate <= self.window <= self.duration:
            raise ValueError(
                f"window must lie between one sample, {1 / self.sample_rate:g} s, and the duration, "
                f"{self.duration:g} s, but {self.window:g} was given"
            )
        _check_track(self.track, self.duration)

    @cached_property
    def motion(self):
        """The Track in force: `track`, or the straight one from start, speed and heading."""
        return self.track or straight_track(self.start, self.speed, self.heading)

    @property
    def samples(self):
        """Number of samples in the record."""
        return round(self.duration * self.sample_rate)

    @property
    def samples_per_window(self):
        """Number of samples in one window."""
        return round(self.window * self.sample_rate)

    @property
    def windows(self):
        """Number of whole windows in the record."""
        return self.samples // self.samples_per_window

    @property
    def time_bandwidth(self):
        """Bandwidth times window, B T; the noise in one window has 2 B T degrees of freedom."""
        return (self.band[1] - self.band[0]) * self.samples_per_window / self.sample_rate


@dataclass(frozen=True)
class Geometry:
    """Where a source heard at `time` (...), s, was at `emitted` (...), s, when the sound left it:
    position (..., 2) m, slant_range (...) m, azimuth (...) rad, angle_from_vertical (...) rad and
    direction (..., 3), the unit vector from sensor to source."""

    time: np.ndarray
    emitted: np.ndarray
    position: np.ndarray
    slant_range: np.ndarray
    azimuth: np.ndarray
    angle_from_vertical: np.ndarray
    direction: np.ndarray


@dataclass(frozen=True)
class Recording:
    """Four channels: time (n,) s, pressure (n,), velocity (n, 3) times rho c, sample_rate Hz."""

    time: np.ndarray
    pressure: np.ndarray
    velocity: np.ndarray
    sample_rate: float


def static_source(azimuth, angle_from_vertical, sensor_depth=100.0, window=0.5, **fields):
    """A PassingVessel that does not pass: at rest in the given direction, heard for one window.

    azimuth, angle_from_vertical : radians, the latter from 0 to below pi/2
    sensor_depth, window, fields : fields of PassingVessel; all but start and speed
    Raises ValueError as PassingVessel does.
    """
    azimuth = require_scalar("azimuth", azimuth)
    angle = require_scalar("angle_from_vertical", angle_from_vertical)
    if not 0 <= angle < np.pi / 2:
        raise ValueError(f"angle_from_vertical must lie from 0 to below pi/2 rad, but {angle:g} was given")
    distance = require_scalar("sensor_depth", sensor_depth) * np.tan(angle)
    start = (distance * np.cos(azimuth), distance * np.sin(azimuth))
    return PassingVessel(sensor_depth, start, speed=0.0, window=window, **({"duration": window} | fields))


def one_window(scenario, time, window):
    """The same vessel and noise of the same level, heard for a single window centred at `time`.

    time : s; window : its length, s. Returns a PassingVessel whose time 0 is the start of the window.
    """
    begin = require_finite("time", time) - require_positive("window", window) / 2
    path, motion = scenario.motion.path, scenario.motion
    track = Track(PPoly(path.c, path.x - begin), motion.start_time - begin, motion.end_time - begin)
    part = replace(scenario, duration=window, window=window, track=track)
    nearer = closest_approach(scenario).slant_range / closest_approach(part).slant_range
    return replace(part, snr_db=scenario.snr_db + decibels(nearer**2))


def window_centres(scenario):
    """The middle of every window, (windows,), s: the time to which a window's estimate belongs."""
    return (np.arange(scenario.windows) + 0.5) * scenario.samples_per_window / scenario.sample_rate


def unit_vector(azimuth, angle_from_vertical):
    """The direction a of two angles (...), radians: Wu & Hu 2010, eq. 1, without its misprint.

    a = (cos az sin el, sin az sin el, cos el), el being the angle from the vertical; the paper prints cos el
    in the second component, and |a| would not be 1. Returns (..., 3).
    """
    across = np.sin(angle_from_vertical)
    x, y = np.cos(azimuth) * across, np.sin(azimuth) * across
    return np.stack([x, y, np.cos(angle_from_vertical)], axis=-1)


def geometry(scenario, time, retarded=True):
    """The source as heard at `time` (...), s: where it was when the sound left it.

    Wu & Hu 2010, eq. 1, has no propagation delay; retarded=False gives that instantaneous geometry.
    Returns a Geometry.
    """
    time = require_finite("time", time)
    emitted = time
    if retarded:
        emitted = retarded_time(scenario.motion, scenario.sensor_depth, time, scenario.sound_speed)
    return _geometry_at(scenario, time, emitted)


def closest_approach(scenario):
    """The Geometry at the moment of the record at which the source is heard from the closest point."""
    ends = np.array([0.0, scenario.duration])
    motion = scenario.motion
    low, high = retarded_time(motion, scenario.sensor_depth, ends, scenario.sound_speed)
    for _ in range(3):
        emitted = np.linspace(low, high, 1001)
        nearest = np.argmin(np.sum(motion.position(emitted) ** 2, axis=-1))
        low, high = emitted[max(nearest - 1, 0)], emitted[min(nearest + 1, 1000)]
    there = _geometry_at(scenario, emitted[nearest], emitted[nearest])
    return replace(there, time=there.emitted + there.slant_range / scenario.sound_speed)


def snr(scenario, time):
    """In-band power ratio of signal and noise in the pressure channel at `time` (...), s.

    Wu & Hu 2010, eq. 8, with the signal alone on top (the paper prints the total pressure, whose
    ratio could never be below 1). It falls as 1/r^2 from `snr_db` at the closest approach.
    """
    distance = geometry(scenario, time).slant_range
    return power_ratio(scenario.snr_db) * (closest_approach(scenario).slant_range / distance) ** 2


def record(scenario, rng, interval=None):
    """What the four channels hear: Wu & Hu 2010, eq. 1, with the travel time of the sound.

    p(t) = s(tau) / r(tau) + n_p, v(t) = s(tau) a(tau) / r(tau) + n_v; tau is the time at
    which the sound heard at t left the vessel, so Doppler and delay are exact. The unit of
    pressure is the root mean square (rms) of the signal at the closest approach. The motion of
    the source is slow: (1 - M)^-2 in amplitude is left out.
    rng : numpy.random.Generator; interval : (from, to), s, to hear only that part
    Returns a Recording. Raises ValueError for an interval outside the record.
    """
    interval = (0, scenario.duration) if interval is None else interval
    begin, end = require_interval("interval", interval, 0, scenario.duration)
    first, last = round(begin * scenario.sample_rate), round(end * scenario.sample_rate)
    time = np.arange(first, max(last, first + 1)) / scenario.sample_rate
    emitted = retarded_time(scenario.motion, scenario.sensor_depth, time, scenario.sound_speed)
    heard = _geometry_at(scenario, time, emitted)
    spreading = closest_approach(scenario).slant_range / heard.slant_range
    signal = spreading * _source_signal(scenario, rng, emitted)
    length = next_fast_len(time.size)
    noise = band_noise(rng, (4, length), scenario.band, scenario.sample_rate)[:, : time.size]
    deviation = np.sqrt(_noise_powers(scenario))
    pressure = signal + deviation[0] * noise[0]
    velocity = signal[:, None] * heard.direction + deviation[1] * noise[1:].T
    return Recording(time, pressure, velocity, scenario.sample_rate)


def averaged_intensity(pressure, velocity, samples_per_window):
    """The mean of pressure times velocity over each window: Wu & Hu 2010, eq. 2, with its 1/T.

    pressure : (..., n); velocity : (..., n, 3); samples_per_window : N, 1 to n
    Returns (..., n // N, 3); samples after the last whole window are left out.
    Raises ValueError for shapes that do not match or a window longer than the record.
    """
    pressure = require_shape("pressure", pressure, (None,))
    velocity = require_shape("velocity", velocity, (pressure.shape[-1], 3))
    samples = pressure.shape[-1]
    length = require_whole("samples_per_window", samples_per_window, 1, samples)
    windows = samples // length
    p = pressure[..., : windows * length].reshape(*pressure.shape[:-1], windows, length)
    v = velocity[..., : windows * length, :].reshape(*velocity.shape[:-2], windows, length, 3)
    return np.einsum("...n,...ni->...i", p, v) / length


def direction_of_arrival(intensity):
    """The direction of an intensity: Wu & Hu 2010, eqs. 3 and 4.

    intensity : (..., 3). Returns azimuth (...) in (-pi, pi] and angle_from_vertical (...)
    in [0, pi], radians; both are NaN where the intensity is zero or NaN. The paper's arctan
    is replaced by arctan2, which knows the quadrant, and for the second angle stays right
    when the vertical component is negative.
    """
    intensity = require_shape("intensity", intensity, (3,))
    x, y, z = np.moveaxis(intensity, -1, 0)
    known = np.where(np.any(intensity != 0, axis=-1), 1.0, np.nan)
    return np.arctan2(y, x) * known, np.arctan2(np.hypot(x, y), z) * known


def window_bisector(scenario):
    """What averaged intensity points at in each window without noise: the bisector of its end directions.

    With 1/r spreading and a straight, constant velocity, the integral of a / r^2 over a window is
    parallel to a(start) + a(end), since the angle swept in the slant plane grows as 1/r^2.
    Returns unit vectors (windows, 3).
    """
    edges = np.arange(scenario.windows + 1) * scenario.samples_per_window / scenario.sample_rate
    ends = geometry(scenario, edges).direction
    both = ends[:-1] + ends[1:]
    return both / np.linalg.norm(both, axis=-1, keepdims=True)


def bisector_lag(scenario, time, window):
    """How far the bisector of a window's end directions lies from the direction at its middle, radians.

    For short windows it grows as window^2 / 8 times the acceleration of the direction on the sphere; the
    azimuth alone does not average (the end that lies farther from overhead weighs more).
    time : (...), middle of the window, s; window : (...), s. Returns azimuth lag (...), angle lag (...).
    """
    half = require_positive("window", window) / 2
    middle = geometry(scenario, time)
    ends = geometry(scenario, time - half).direction + geometry(scenario, time + half).direction
    azimuth, angle = direction_of_arrival(ends)
    return angle_difference(azimuth, middle.azimuth), angle - middle.angle_from_vertical


def sample_intensity(scenario, rng, trials, blocks=BLOCKS):
    """Averaged intensities of many records, drawn from their law without making waveforms.

    A block in which the source hardly moves has K = 2 B T real degrees of freedom. With
    P = S + Np, the mean square pressure is W = P chi2_K / K, and given the pressure the
    intensity is Gaussian: I = (S/P) W a + sqrt(W/K) (sqrt(Nv) z + sqrt(S Np / P) z0 a)
    (the Bartlett decomposition). This law is exact for 2 B T independent samples, and very
    nearly so for band noise when B T is large. A window is the mean of `blocks` such blocks,
    so the motion within it is kept.
    Returns (trials, windows, 3), in the units of `averaged_intensity`.
    """
    a, signal = _blocks(scenario, blocks)
    noise, velocity_noise = _noise_powers(scenario)
    freedom = 2 * scenario.time_bandwidth / blocks
    total = signal + noise
    energy = total * rng.standard_gamma(freedom / 2, (trials, *signal.shape)) / (freedom / 2)
    along = signal / total * energy
    along += np.sqrt(energy * (signal * noise / total / freedom)) * rng.standard_normal(energy.shape)
    across = np.sqrt(velocity_noise * energy.sum(axis=-1) / freedom) / blocks
    isotropic = across[..., None] * rng.standard_normal((trials, scenario.windows, 3))
    return np.einsum("twb,wbi->twi", along, a) / blocks + isotropic


def sample_covariance(scenario, rng, trials, blocks=BLOCKS):
    """Sample covariances of (p, vx, vy, vz) in each window, drawn from the Wishart law.

    The law is that of `sample_intensity`, whose intensities are the elements [..., 0, 1:]; exact for
    2 B T independent samples, very nearly so for band noise when B T is large.
    Returns (trials, windows, 4, 4). Raises ValueError if a block has no more than 3 degrees of freedom.
    """
    a, signal = _blocks(scenario, blocks)
    freedom = 2 * scenario.time_bandwidth / blocks
    if freedom <= 3:
        raise ValueError(f"2 B T / blocks must be above 3, but {freedom:g} was given; widen band or window")
    h = np.concatenate([np.ones((*signal.shape, 1)), a], axis=-1)
    noise, velocity_noise = _noise_powers(scenario)
    truth = signal[..., None, None] * h[..., :, None] * h[..., None, :]
    root = np.linalg.cholesky(truth + np.diag([noise, velocity_noise, velocity_noise, velocity_noise]))
    factor = np.tril(rng.standard_normal((trials, *signal.shape, 4, 4)), -1)
    degrees = freedom - np.arange(4)
    diagonal = np.sqrt(2 * rng.standard_gamma(degrees / 2, (trials, *signal.shape, 4)))
    factor[..., np.arange(4), np.arange(4)] = diagonal
    factor = root @ factor
    return np.einsum("twbij,twbkj->twik", factor, factor, optimize=True) / (freedom * blocks)


def maximum_likelihood_direction(covariance, velocity_noise_ratio=1.0):
    """The direction under which a Gaussian record is most likely.

    Source power and noise level are free, the noise ratio Nv/Np is known; an unknown waveform
    that is not random has the same likeliest direction. It maximises a' Rvv a + 2 (Nv/Np) a' Rpv
    over unit vectors a; averaged intensity keeps the second term alone. The maximum is
    a = (lambda - Rvv)^-1 b, b = (Nv/Np) Rpv, with lambda the largest root of the secular
    equation |a| = 1, reached from below by Newton's method on 1/|a|.
    covariance : (..., 4, 4) of (p, vx, vy, vz); velocity_noise_ratio : Nv/Np
    Returns azimuth (...), angle_from_vertical (...), radians; NaN where Rpv is zero or a value not finite.
    """
    covariance = require_shape("covariance", covariance, (4, 4))
    known = np.isfinite(covariance).all(axis=(-2, -1), keepdims=True)
    covariance = np.where(known, covariance, 0.0)
    ratio = require_positive("velocity_noise_ratio", velocity_noise_ratio)
    level = np.trace(covariance, axis1=-2, axis2=-1)[..., None, None]
    covariance = covariance / np.where(level > 0, level, 1.0)
    power, axes = np.linalg.eigh(covariance[..., 1:, 1:])
    b = np.einsum("...ij,...i->...j", axes, ratio * covariance[..., 0, 1:])
    a = _unit_solution(b, power[..., -1:] - power)
    return direction_of_arrival(np.nan_to_num(np.einsum("...ij,...j->...i", axes, a)))


def intensity_error(snr, time_bandwidth, velocity_noise_ratio=1.0):
    """Standard deviation, radians, of the direction of averaged intensity across the line of sight.

    sigma^2 = (1 / 2BT) (Nv/S) (1 + Np/S): only noise across a turns the intensity. The angle from the
    vertical has this error, the azimuth has sigma / sin(angle_from_vertical); valid while small.
    snr : S/Np (...); time_bandwidth : B T; velocity_noise_ratio : Nv/Np. Returns (...).
    """
    snr, time_bandwidth, ratio = _error_arguments(snr, time_bandwidth, velocity_noise_ratio)
    return np.sqrt(ratio / snr * (1 + 1 / snr) / (2 * time_bandwidth))


def expected_error(scenario, time):
    """The `intensity_error` of a vessel's windows centred at `time` (...), s: (...), radians."""
    return intensity_error(snr(scenario, time), scenario.time_bandwidth, scenario.velocity_noise_ratio)


def cramer_rao_bound(snr, time_bandwidth, velocity_noise_ratio=1.0):
    """The least standard deviation, radians, of any unbiased direction across the line of sight.

    sigma^2 = Nv (1 + S G) / (2BT S^2 G), G = 1/Np + 1/Nv, for a Gaussian source with flat spectra;
    not knowing the powers of source and noise costs nothing. Azimuth: sigma / sin(angle_from_vertical).
    snr : S/Np (...); time_bandwidth : B T; velocity_noise_ratio : Nv/Np. Returns (...).
    """
    snr, time_bandwidth, ratio = _error_arguments(snr, time_bandwidth, velocity_noise_ratio)
    gain = 1 + 1 / ratio
    return np.sqrt(ratio * (1 + snr * gain) / (2 * time_bandwidth * snr**2 * gain))


def best_window(error_in_one_second, bearing_acceleration):
    """The window with the least mean square error for a moving source, s.

    Noise leaves sigma1^2 / T and the bisector lags the middle by beta'' T^2 / 8, so that
    T^5 = 16 sigma1^2 / beta''^2. The source's own noise, rate^2 T / 12B, is left out: at a high SNR and
    a fast turn the best window is shorter still.
    error_in_one_second : sigma1, the error of a window of 1 s, rad
    bearing_acceleration : beta'', rad/s^2, not 0; 8 / T^2 times the `bisector_lag` of a short window T
    """
    sigma = require_positive("error_in_one_second", error_in_one_second)
    curvature = require_positive("bearing_acceleration", np.abs(bearing_acceleration))
    return (16 * sigma**2 / curvature**2) ** 0.2


def load_recording(wav, order="pxyz", gains=(1.0, 1.0, 1.0, 1.0)):
    """Read a recorded vector sensor from a WAV file with four channels.

    order : how the file is laid out
        "pxyz" : pressure, then the velocities times rho c along x, y, z (up), positive towards the source
        "fuma" : first-order ambisonics W, X, Y, Z, with W = pressure / sqrt(2)
        "sn3d" : first-order ambisonics W, Y, Z, X (ACN order, SN3D scale)
    gains : factors for the file's four channels, in the file's order, for what calibration says
    Integer samples are read as fractions of full scale. Returns a Recording.
    Raises ValueError for a file that is not WAV or has not four channels, and for values not finite.
    """
    require_choice("order", order, tuple(CHANNEL_ORDERS))
    gains = require_shape("gains", require_finite("gains", gains), (4,))
    name = Path(wav).name
    try:
        rate, data = wavfile.read(wav)
    except (ValueError, struct.error, UnboundLocalError) as error:
        raise ValueError(f"wav must be a WAV file, but {name} cannot be read as one: {error}") from None
    channels = 1 if data.ndim == 1 else data.shape[1]
    if channels != 4:
        raise ValueError(f"wav must have 4 channels, {order}, but {name} has {channels}")
    samples = require_finite(f"samples of {name}", _full_scale(data) * gains)
    places, pressure_gain = CHANNEL_ORDERS[order]
    pressure, *velocity = samples[:, places].T
    velocity = np.stack(velocity, axis=-1)
    return Recording(np.arange(len(data)) / rate, pressure_gain * pressure, velocity, float(rate))


def _check_track(track, duration):
    if track is None:
        return
    if not isinstance(track, Track):
        raise ValueError(f"track must be a labsim.motion.Track, but {track!r} was given")
    if track.start_time > 0 or track.end_time < duration:
        raise ValueError(
            f"track must cover the record from 0 to {duration:g} s, "
            f"but one from {track.start_time:g} to {track.end_time:g} s was given"
        )


def _geometry_at(scenario, time, emitted):
    position = scenario.motion.position(emitted)
    x, y = np.moveaxis(position, -1, 0)
    horizontal = np.hypot(x, y)
    distance = np.hypot(horizontal, scenario.sensor_depth)
    azimuth, angle = np.arctan2(y, x), np.arctan2(horizontal, scenario.sensor_depth)
    return Geometry(time, emitted, position, distance, azimuth, angle, unit_vector(azimuth, angle))


def _noise_powers(scenario):
    pressure = 1 / power_ratio(scenario.snr_db)
    return np.array([pressure, scenario.velocity_noise_ratio * pressure])


def _unit_solution(b, gap):
    """The unit vector b / (step + gap) of the secular equation; gap (..., 3) falls to 0 in the last place.

    Without a part of b there, no step may make the vector long enough; the rest then lies in that place.
    """
    step = np.maximum(np.abs(b[..., -1:]), 1e-12 * np.linalg.norm(b, axis=-1, keepdims=True))
    with np.errstate(invalid="ignore", divide="ignore"):
        rest = b[..., :-1] / (step + gap[..., :-1])
        missing = 1 - np.sum(rest**2, axis=-1, keepdims=True)
        short = np.sum((b / (step + gap)) ** 2, axis=-1, keepdims=True) < 1
        upright = np.sqrt(np.maximum(missing, 0)) * np.where(b[..., -1:] < 0, -1, 1)
        for _ in range(30):
            a = b / (step + gap)
            length2 = np.sum(a**2, axis=-1, keepdims=True)
            slope = np.sum(a**2 / (step + gap), axis=-1, keepdims=True)
            step = step + np.where(short, 0, (np.sqrt(length2) - 1) * length2 / slope)
            if not np.any(np.abs(length2 - 1)[~short] > 1e-12):
                break
    return np.where(short, np.concatenate([rest, upright], axis=-1), a)


def _source_signal(scenario, rng, emitted):
    rate = scenario.sample_rate * np.ceil(scenario.band[1] / (0.25 * scenario.sample_rate))
    margin = 8 / rate
    length = next_fast_len(int(np.ceil((np.ptp(emitted) + 2 * margin) * rate)) + 1)
    source = band_noise(rng, length, scenario.band, rate)
    return sample_at(source, rate, emitted - emitted.min() + margin)


def _blocks(scenario, blocks):
    blocks = require_whole("blocks", blocks, 1)
    duration = scenario.samples_per_window / scenario.sample_rate
    time = (np.arange(scenario.windows * blocks) + 0.5) * duration / blocks
    heard = geometry(scenario, time)
    signal = (closest_approach(scenario).slant_range / heard.slant_range) ** 2
    shape = (scenario.windows, blocks)
    return heard.direction.reshape(*shape, 3), signal.reshape(shape)


def _error_arguments(snr, time_bandwidth, velocity_noise_ratio):
    return (
        require_positive("snr", snr),
        require_positive("time_bandwidth", time_bandwidth),
        require_positive("velocity_noise_ratio", velocity_noise_ratio),
    )


def _full_scale(data):
    if data.dtype == np.uint8:
        return (data - 128.0) / 128.0
    if np.issubdtype(data.dtype, np.integer):
        return data / (np.iinfo(data.dtype).max + 1.0)
    return data.astype(float)
