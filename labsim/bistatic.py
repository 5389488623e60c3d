"""Bistatic active sonar: one place pings, another listens, and a moving target scatters between them.

The receiver measures a bearing, the delay of the echo (the target lies on an ellipse around source and
receiver) and a Doppler shift; bearing and delay together give a position. Equations of Ma et al. 2023
(Applied Acoustics 42(2), section 1), mended where noted; the scenario and its numbers are the lab's own.
State vectors are [x, vx, y, vy]; bearings are from the x axis, counter-clockwise.
"""

from dataclasses import dataclass

import numpy as np

from labsim.arguments import (
    require_between,
    require_finite,
    require_interval,
    require_not_negative,
    require_positive,
    require_scalar,
    require_shape,
    require_whole,
)
from labsim.noise import power_ratio

CLUTTER, NOTHING = -3, -4  # in place of the index of a target


@dataclass(frozen=True)
class BistaticScenario:
    """Four targets that come and go, watched for 100 scans by a source and a receiver 4 km apart.

    Lengths in m, times in s, frequencies in Hz; the receiving array lies along the x axis. `targets` holds
    one row a target: scan of birth, scan of death (excluded), x, vx, y, vy at birth. Floors are what no SNR
    improves: array shape, ping timing, drift.
    """

    receiver: tuple = (0.0, 0.0)
    source: tuple = (4_000.0, 0.0)
    sound_speed: float = 1_500.0
    frequency: float = 3_000.0
    period: float = 20.0
    scans: int = 100
    source_level_db: float = 215.0
    noise_level_db: float = 60.0
    absorption_db_per_km: float = 0.2
    target_strength_db: tuple = (5.0, 20.0)
    snr_limits_db: tuple = (0.0, 25.0)
    elements: int = 16
    spacing: float = 0.25
    bandwidth: float = 100.0
    pulse_length: float = 1.0
    bearing_floor_deg: float = 0.3
    delay_floor: float = 0.010
    doppler_floor: float = 0.3
    bearing_region_deg: tuple = (10.0, 170.0)
    delay_region: tuple = (3.2, 14.0)
    doppler_region: tuple = (-40.0, 40.0)
    detection_probability: float = 0.9
    clutter_rate: float = 20.0
    clutter_snr_db: tuple = (0.0, 20.0)
    targets: tuple = (
        (0, 100, -5_900.0, 3.0, 5_100.0, -0.5),
        (0, 70, 100.0, 0.5, 7_900.0, -3.0),
        (20, 100, 6_100.0, -3.0, 6_100.0, -1.0),
        (40, 90, 3_100.0, -1.0, 2_400.0, 2.0),
    )

    def __post_init__(self):
        for name in ("sound_speed", "frequency", "period", "spacing", "bandwidth", "pulse_length"):
            require_positive(name, require_scalar(name, getattr(self, name)))
        for name in ("bearing_floor_deg", "delay_floor", "doppler_floor", "clutter_rate"):
            require_not_negative(name, require_scalar(name, getattr(self, name)))
        for name in ("source_level_db", "noise_level_db", "absorption_db_per_km", "detection_probability"):
            require_scalar(name, getattr(self, name))
        require_between("detection_probability", self.detection_probability, 0, 1)
        require_whole("scans", self.scans, 1)
        require_whole("elements", self.elements, 2)
        for name in ("receiver", "source", "target_strength_db"):
            _require_pair(name, getattr(self, name))
        for name in ("bearing_region_deg", "delay_region", "doppler_region"):
            require_interval(name, getattr(self, name))
        for name in ("snr_limits_db", "clutter_snr_db"):
            require_interval(name, getattr(self, name))
        _require_delay("delay_region", self.delay_region, *self.geometry)
        targets = np.reshape(require_finite("targets", self.targets), (-1, 6))
        _require_slower("velocity of targets", targets[:, 3::2], self.sound_speed)

    @property
    def geometry(self):
        """(receiver, source, sound_speed), the arguments that every formula of the geometry takes."""
        return self.receiver, self.source, self.sound_speed


@dataclass(frozen=True)
class Detections:
    """Everything the receiver reports: (..., scans, n) arrays, NaN where there is no detection.

    bearing : radians; delay : s; doppler : shift, Hz; snr : power ratio
    origin : index of the target, CLUTTER, or NOTHING
    """

    bearing: np.ndarray
    delay: np.ndarray
    doppler: np.ndarray
    snr: np.ndarray
    origin: np.ndarray

    def scan(self, index):
        """The detections of one scan of one run, without the empty places: Detections with arrays (n,)."""
        fields = (self.bearing, self.delay, self.doppler, self.snr, self.origin)
        seen = self.origin[index] != NOTHING
        return Detections(*(field[index][seen] for field in fields))

    def all_scans(self):
        """All detections of one run in one row, (n,), and the places (scans - 1,) at which to split it."""
        seen = self.origin != NOTHING
        fields = (self.bearing, self.delay, self.doppler, self.snr, self.origin)
        return Detections(*(field[seen] for field in fields)), np.cumsum(seen.sum(axis=-1))[:-1]


def bearing_and_delay(position, receiver, source, sound_speed):
    """Bearing of the target and delay of its echo (Ma et al. 2023, eqs. 1-2).

    position : (..., 2), m. Returns (bearing, delay): radians from the x axis, s.
    Raises ValueError for a target at the receiver, where there is no bearing.
    """
    require_positive("sound_speed", sound_speed)
    (near, _), (far, _) = _lines_of_sight(position, receiver, source)
    line = np.asarray(position, dtype=float) - receiver
    return np.arctan2(line[..., 1], line[..., 0]), (near + far) / sound_speed


def doppler_ratio(position, velocity, receiver, source, sound_speed):
    """Received over transmitted frequency for a moving target, exact (Ma et al. 2023, eq. 3).

    position, velocity : (..., 2), m and m/s. Returns (...). Raises ValueError for a target at the source or
    the receiver, or one not slower than sound.
    """
    _require_slower("velocity", velocity, sound_speed)
    (_, to_receiver), (_, to_source) = _lines_of_sight(position, receiver, source)
    towards_source, towards_receiver = _dot(velocity, to_source), _dot(velocity, to_receiver)
    return (1 + towards_source / sound_speed) / (1 - towards_receiver / sound_speed)


def locate(bearing, delay, receiver, source, sound_speed):
    """Position from bearing and delay: where the ray meets the ellipse (Ma et al. 2023, eq. 9).

    bearing : radians from the x axis; delay : s. Returns (..., 2), m.
    Mended: the angle inside the range formula is that to the baseline, the direction is the bearing; the
    paper writes one symbol for both, true only for a baseline along the x axis.
    Raises ValueError for a delay not longer than the direct path's.
    """
    distance = ellipse_range(bearing, delay, receiver, source, sound_speed)
    direction = np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
    return np.asarray(receiver, dtype=float) + distance[..., None] * direction


def ellipse_range(bearing, delay, receiver, source, sound_speed):
    """Distance from receiver to ellipse along a bearing, m (the fraction of Ma et al. 2023, eq. 9)."""
    path = sound_speed * _require_delay("delay", delay, receiver, source, sound_speed)
    baseline, inclination = _baseline(receiver, source)
    return (path**2 - baseline**2) / (2 * (path - baseline * np.cos(bearing - inclination)))


def location_jacobian(bearing, delay, receiver, source, sound_speed):
    """Derivatives of the position by bearing and delay: (..., 2, 2), m/rad and m/s in the columns.

    Raises ValueError for a delay not longer than the direct path's: on the baseline they have no limit.
    """
    distance = ellipse_range(bearing, delay, receiver, source, sound_speed)
    baseline, inclination = _baseline(receiver, source)
    path = sound_speed * np.asarray(delay, dtype=float)
    excess = path - baseline * np.cos(bearing - inclination)
    by_bearing = -distance * baseline * np.sin(bearing - inclination) / excess
    by_delay = sound_speed * (path - distance) / excess
    cosine, sine = np.cos(bearing), np.sin(bearing)
    x_row = np.stack([by_bearing * cosine - distance * sine, by_delay * cosine], axis=-1)
    y_row = np.stack([by_bearing * sine + distance * cosine, by_delay * sine], axis=-1)
    return np.stack([x_row, y_row], axis=-2)


def location_covariance(jacobian, bearing_variance, delay_variance):
    """First-order covariance of the position, (..., 2, 2), m^2 (Ma et al. 2023, section 1.4).

    jacobian : (..., 2, 2), from `location_jacobian`; variances (...) in rad^2 and s^2
    """
    variance = np.stack(np.broadcast_arrays(bearing_variance, delay_variance), axis=-1)
    return (jacobian * variance[..., None, :]) @ np.swapaxes(jacobian, -1, -2)


def observe(state, frequency, receiver, source, sound_speed):
    """Bearing, delay and Doppler shift that states predict (Ma et al. 2023, eqs. 1-3), and their derivatives.

    state : (..., 4), [x, vx, y, vy]. Returns (values (..., 3), jacobian (..., 3, 4)) in rad, s, Hz.
    Raises ValueError as `doppler_ratio` does.
    """
    position, velocity = np.asarray(state)[..., 0::2], np.asarray(state)[..., 1::2]
    bearing, delay = bearing_and_delay(position, receiver, source, sound_speed)
    ratio = doppler_ratio(position, velocity, receiver, source, sound_speed)
    values = np.stack([bearing, delay, frequency * (ratio - 1)], axis=-1)
    (near, to_receiver), (far, to_source) = _lines_of_sight(position, receiver, source)
    jacobian = np.zeros((*values.shape, 4))
    jacobian[..., 0, 0] = to_receiver[..., 1] / near
    jacobian[..., 0, 2] = -to_receiver[..., 0] / near
    jacobian[..., 1, 0::2] = -(to_receiver + to_source) / sound_speed
    ratio = ratio[..., None]
    gain = frequency / (sound_speed - _dot(velocity, to_receiver))[..., None]
    jacobian[..., 2, 1::2] = gain * (to_source + ratio * to_receiver)
    turn = _turn(velocity, to_source, far) + ratio * _turn(velocity, to_receiver, near)
    jacobian[..., 2, 0::2] = gain * turn
    return values, jacobian


def observer(scenario):
    """`observe` with the scenario's geometry and frequency, as a filter takes it: a function of states."""
    return lambda state: observe(state, scenario.frequency, *scenario.geometry)


def bearing_bound(snr, bearing, frequency, elements, spacing, sound_speed, factor=12):
    """Variance bound of a bearing from a line array, rad^2 (Ma et al. 2023, eq. 4).

    snr : power ratio at one element; bearing : from the array's axis, radians
    factor : 12 for real data with snr = A^2/(2 sigma^2), 6 for complex snapshots with snr = A^2/sigma^2
    """
    snr = require_positive("snr", snr)
    aperture = frequency * spacing * np.sin(bearing) / sound_speed
    return factor / ((2 * np.pi) ** 2 * snr * elements * (elements**2 - 1.0) * aperture**2)


def printed_delay_bound(snr, frequency, elements):
    """Variance of a delay from the phase of a tone, s^2 (Ma et al. 2023, eq. 5, as printed).

    It is a bound on phase divided by 2 pi f: ambiguous every 1/f, so not an accuracy of arrival time.
    """
    snr = require_positive("snr", snr)
    return (2 * elements - 1) / (2 * np.pi**2 * snr * elements * (elements + 1) * frequency**2)


def delay_bound(snr, bandwidth):
    """Variance bound of the delay of a pulse with a flat band, s^2: 3 / (2 pi^2 B^2 snr).

    snr : ratio of pulse energy to noise density. Stands in for eq. 5 of Ma et al. 2023.
    """
    return 3 / (2 * np.pi**2 * require_positive("bandwidth", bandwidth) ** 2 * require_positive("snr", snr))


def doppler_bound(snr, pulse_length):
    """Variance bound of the frequency of a pulse, Hz^2: 12 / ((2 pi)^2 snr T^2).

    snr : ratio of pulse energy to noise density. Eq. 6 of Ma et al. 2023 for many samples, in Hz instead of
    cycles per sample; the page uses N both for elements and for samples.
    """
    phase = 2 * np.pi * require_positive("pulse_length", pulse_length)
    return 12 / (require_positive("snr", snr) * phase**2)


def target_strength(position, velocity, receiver, source, limits_db):
    """Aspect-dependent target strength, dB: the lower limit end-on, the upper limit broadside.

    limits_db : (end-on, broadside); the aspect is the angle from the heading to the bistatic bisector.
    """
    (_, to_receiver), (_, to_source) = _lines_of_sight(position, receiver, source)
    bisector = to_receiver + to_source
    lengths = _dot(bisector, bisector) * _dot(velocity, velocity)
    along = _dot(bisector, np.asarray(velocity)) ** 2 / np.where(lengths > 0, lengths, 1.0)
    return limits_db[0] + (limits_db[1] - limits_db[0]) * (1 - along)


def echo_snr_db(scenario, position, velocity):
    """SNR of an echo, dB: SL - TL - TL - NL + TS (Ma et al. 2023, eq. 7), within the scenario's limits.

    Mended: eq. 7 subtracts the detection threshold too; the signal excess plus that threshold is the SNR.
    position, velocity : (..., 2). Returns (...).
    """
    legs = [leg for leg, _ in _lines_of_sight(position, scenario.receiver, scenario.source)]
    loss = sum(20 * np.log10(leg) + scenario.absorption_db_per_km * leg / 1_000 for leg in legs)
    strength = target_strength(
        position, velocity, scenario.receiver, scenario.source, scenario.target_strength_db
    )
    level = scenario.source_level_db - loss - scenario.noise_level_db + strength
    return np.clip(level, *scenario.snr_limits_db)


def measurement_variance(scenario, bearing, snr):
    """Variances of bearing, delay and Doppler at a given SNR, floors included: (..., 3), rad^2, s^2, Hz^2."""
    bound = bearing_bound(
        snr, bearing, scenario.frequency, scenario.elements, scenario.spacing, scenario.sound_speed
    )
    return np.stack(
        [
            bound + np.radians(scenario.bearing_floor_deg) ** 2,
            delay_bound(snr, scenario.bandwidth) + scenario.delay_floor**2,
            doppler_bound(snr, scenario.pulse_length) + scenario.doppler_floor**2,
        ],
        axis=-1,
    )


def true_states(scenario):
    """States of the targets at every scan: (scans, targets, 4), NaN while a target is absent."""
    birth, death, *state = np.reshape(np.asarray(scenario.targets, dtype=float), (-1, 6)).T
    x, vx, y, vy = state
    scan = np.arange(scenario.scans)[:, None]
    age = scenario.period * (scan - birth)
    states = np.stack(np.broadcast_arrays(x + vx * age, vx, y + vy * age, vy), axis=-1)
    alive = (scan >= birth) & (scan < death)
    return np.where(alive[..., None], states, np.nan)


def simulate_detections(rng, scenario, runs=()):
    """Detections of all scans: targets with their own SNR, misses, and clutter uniform in measurement space.

    rng : numpy.random.Generator; runs : leading shape
    Returns Detections with arrays (*runs, scans, n): first the targets in order, then clutter.
    """
    states = true_states(scenario)
    shape = (*np.atleast_1d(np.asarray(runs, dtype=int)), *states.shape[:2])
    alive = np.isfinite(states[..., 0])
    elsewhere = [scenario.receiver[0] + 1.0, 0.0, scenario.receiver[1] + 1.0, 0.0]
    states = np.where(alive[..., None], states, elsewhere)
    values, _ = observer(scenario)(states)
    snr = power_ratio(echo_snr_db(scenario, states[..., 0::2], states[..., 1::2]))
    spread = np.sqrt(measurement_variance(scenario, values[..., 0], snr))
    noisy = values + spread * rng.standard_normal((*shape, 3))
    heard = alive & (rng.random(shape) < scenario.detection_probability)
    clutter, clutter_snr = _clutter(rng, scenario, shape[:-1])
    measured = np.concatenate([np.where(heard[..., None], noisy, np.nan), clutter], axis=-2)
    origin = np.where(heard, np.arange(shape[-1]), NOTHING)
    origin = np.concatenate([origin, np.where(np.isfinite(clutter_snr), CLUTTER, NOTHING)], axis=-1)
    snr = np.concatenate([np.where(heard, snr, np.nan), clutter_snr], axis=-1)
    bearing, delay, doppler = np.moveaxis(measured, -1, 0)
    return Detections(bearing, delay, doppler, snr, origin)


def clutter_density(scenario, doppler=False):
    """Expected clutter per scan and unit of measurement space, per (rad s) or per (rad s Hz)."""
    volume = np.radians(np.ptp(scenario.bearing_region_deg)) * np.ptp(scenario.delay_region)
    return scenario.clutter_rate / (volume * np.ptp(scenario.doppler_region) if doppler else volume)


def region_area(scenario):
    """Area of the map that the bearing and delay regions cover, m^2, by the midpoint rule over bearing."""
    low, high = np.radians(scenario.bearing_region_deg)
    bearing = low + (high - low) * (np.arange(2_000) + 0.5) / 2_000
    near, far = (ellipse_range(bearing, delay, *scenario.geometry) for delay in scenario.delay_region)
    return float(np.mean(far**2 - near**2) / 2 * (high - low))


def native_measurements(scenario, scan, doppler=True):
    """(value, covariance, clutter) of one scan in bearing, delay and, if asked, Doppler.

    scan : Detections with arrays (n,). Returns (n, d), (n, d, d) and (n,) with d = 3 or 2.
    """
    size = 3 if doppler else 2
    value = np.stack([scan.bearing, scan.delay, scan.doppler][:size], axis=-1)
    variance = measurement_variance(scenario, scan.bearing, scan.snr)[..., :size]
    return value, variance[..., None] * np.eye(size), np.full(len(value), clutter_density(scenario, doppler))


def converted_measurements(scenario, scan):
    """(value, covariance, clutter) of one scan in x and y (Ma et al. 2023, eq. 9 and section 1.4).

    scan : Detections with arrays (n,). Returns (n, 2), (n, 2, 2) and (n,). Clutter uniform in bearing and
    delay is not uniform in the plane: its density there is divided by |det J|.
    Raises ValueError for a delay not longer than the direct path's.
    """
    jacobian = location_jacobian(scan.bearing, scan.delay, *scenario.geometry)
    variance = measurement_variance(scenario, scan.bearing, scan.snr)
    covariance = location_covariance(jacobian, variance[..., 0], variance[..., 1])
    area = np.abs(jacobian[..., 0, 0] * jacobian[..., 1, 1] - jacobian[..., 0, 1] * jacobian[..., 1, 0])
    return locate(scan.bearing, scan.delay, *scenario.geometry), covariance, clutter_density(scenario) / area


def _clutter(rng, scenario, shape):
    count = rng.poisson(scenario.clutter_rate, shape)
    present = np.arange(count.max(initial=0)) < count[..., None]
    low, high = np.transpose(
        [np.radians(scenario.bearing_region_deg), scenario.delay_region, scenario.doppler_region]
    )
    values = rng.uniform(low, high, (*present.shape, 3))
    snr = power_ratio(rng.uniform(*scenario.clutter_snr_db, present.shape))
    return np.where(present[..., None], values, np.nan), np.where(present, snr, np.nan)


def _turn(velocity, unit, distance):
    across = velocity - _dot(velocity, unit)[..., None] * unit
    return -across / distance[..., None]


def _dot(a, b):
    return a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1]


def _baseline(receiver, source):
    x, y = np.asarray(source, dtype=float) - np.asarray(receiver, dtype=float)
    if x == 0 and y == 0:
        raise ValueError("source and receiver must be apart; at one place the sonar is not bistatic")
    return np.hypot(x, y), np.arctan2(y, x)


def _lines_of_sight(position, receiver, source):
    """(distance (...), unit vector (..., 2)) from the target to the receiver, and the same to the source."""
    position, lines = require_shape("position", position, (2,)), []
    for name, end in (("receiver", receiver), ("source", source)):
        line = np.asarray(end, dtype=float) - position
        distance = np.hypot(line[..., 0], line[..., 1])
        if not np.all(distance):
            raise ValueError(f"position must not be at the {name}, but a target was there")
        lines.append((distance, line / distance[..., None]))
    return lines


def _require_delay(name, delay, receiver, source, sound_speed):
    delay = require_finite(name, delay)
    direct = _baseline(receiver, source)[0] / require_positive("sound_speed", sound_speed)
    if np.any(delay <= direct):
        raise ValueError(
            f"{name} must be longer than the direct path's, {direct:.6g} s, "
            f"but {np.min(delay):.6g} was given; on the baseline no position follows"
        )
    return delay


def _require_slower(name, velocity, sound_speed):
    velocity = require_shape(name, require_finite(name, velocity), (2,))
    speed = np.sqrt(np.max(_dot(velocity, velocity), initial=0.0))
    if speed >= sound_speed:
        raise ValueError(f"{name} must be slower than sound, {sound_speed:g} m/s, but {speed:g} was given")


def _require_pair(name, value):
    pair = require_shape(name, require_finite(name, value), (2,))
    if pair.ndim != 1:
        raise ValueError(f"{name} must be two numbers, but an array of shape {pair.shape} was given")
