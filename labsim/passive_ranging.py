"""Range and bearing of a distant source from the delays between three hydrophones on one line.

A sound wave is a sphere around its source: over an arm of 50 m, at 5 km, it bends by 25 cm, and that
bend is all there is to measure a range with. Source: a report of the Norwegian Defence Research
Establishment on passive ranging (Chinese translation), sections 2 and 4.4, called "the paper" here.
"""

from dataclasses import dataclass, replace

import numpy as np

from labsim.arguments import (
    require_between,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)

ON_AXIS = 1e-6


@dataclass(frozen=True)
class Triplet:
    """Three hydrophones on a line, the middle one perhaps out of place.

    The body has the axes eta (along the line, from H1 to H3), zeta (broadside, towards bearing 0)
    and xi (up). H1, H2 and H3 belong at -spacing, 0 and +spacing on eta.

    spacing : a, from the middle hydrophone to either outer one, m, above 0
    displacement : (..., 3), where H2 is minus where it belongs, along eta, zeta, xi, m; may be a batch
    pitch, roll : of the body, radians, within 1.4 of 0
    sound_speed : c, m/s, above 0
    """

    spacing: float = 50.0
    displacement: tuple = (0.0, 0.0, 0.0)
    pitch: float = 0.0
    roll: float = 0.0
    sound_speed: float = 1500.0

    def __post_init__(self):
        require_positive("spacing", self.spacing)
        require_shape("displacement", require_finite("displacement", self.displacement), (3,))
        require_between("pitch", self.pitch, -1.4, 1.4)
        require_between("roll", self.roll, -1.4, 1.4)
        require_positive("sound_speed", self.sound_speed)


@dataclass(frozen=True)
class ErrorTable:
    """Relative range errors, each (ranges, displacements, axes, bearings); 0.01 is one per cent too far.

    exact : from exact delays; first_order : -q; closed_form : -q / (1 + q), q = `displacement_ratio`
    Axes in the order eta, zeta, xi. Infinite: no curvature was left. NaN: the target seems to be behind.
    """

    exact: np.ndarray
    first_order: np.ndarray
    closed_form: np.ndarray


def target_at(target_range, bearing, elevation=0.0):
    """Position of a target in level axes: along the line, broadside, up.

    target_range : (...), m, above 0; bearing : (...), radians from broadside towards H3
    elevation : (...), radians above the horizontal
    Returns (..., 3), m.
    """
    return require_positive("target_range", target_range)[..., None] * direction(bearing, elevation)


def direction(bearing, elevation=0.0):
    """Unit vectors (..., 3) towards a bearing and an elevation, radians."""
    bearing, elevation = np.broadcast_arrays(bearing, elevation)
    level = np.cos(elevation)
    return np.stack([np.sin(bearing) * level, np.cos(bearing) * level, np.sin(elevation)], axis=-1)


def array_axes(triplet):
    """The body's axes eta, zeta, xi as the rows of a (3, 3) matrix in level axes.

    Pitch lifts H3, roll dips the broadside axis. The three rows times `direction` are the three
    bracketed coefficients of the paper's eq. 2.3.
    """
    cos_pitch, sin_pitch = np.cos(triplet.pitch), np.sin(triplet.pitch)
    cos_roll, sin_roll = np.cos(triplet.roll), np.sin(triplet.roll)
    return np.array(
        [
            [cos_pitch, 0.0, sin_pitch],
            [sin_roll * sin_pitch, cos_roll, -sin_roll * cos_pitch],
            [-cos_roll * sin_pitch, sin_roll, cos_roll * cos_pitch],
        ]
    )


def hydrophone_positions(triplet):
    """Where H1, H2 and H3 really are, in level axes: (..., 3, 3), m; rows are hydrophones."""
    displacement = np.asarray(triplet.displacement, dtype=float)
    body = np.zeros((*displacement.shape[:-1], 3, 3))
    body[..., 0, 0], body[..., 2, 0] = -triplet.spacing, triplet.spacing
    body[..., 1, :] = displacement
    return body @ array_axes(triplet)


def arrival_delays(triplet, target):
    """Exact delays of a spherical wave: tau_ij = (r_i - r_j) / c.

    target : (..., 3), m, in level axes; its leading axes broadcast against those of the displacement
    Returns tau12, tau23, each (...), s.
    """
    target = require_shape("target", require_finite("target", target), (3,))
    distance = np.linalg.norm(target[..., None, :] - hydrophone_positions(triplet), axis=-1)
    delay = -np.diff(distance, axis=-1) / triplet.sound_speed
    return delay[..., 0], delay[..., 1]


def mean_and_difference(tau12, tau23):
    """The mean delay tau, which carries the bearing, and the difference eps, which carries the range.

    The paper's eq. 2.4: tau = (tau12 + tau23) / 2, eps = tau12 - tau23; all in s.
    """
    tau12, tau23 = np.asarray(tau12, dtype=float), np.asarray(tau23, dtype=float)
    return (tau12 + tau23) / 2, tau12 - tau23


def bearing_from_delay(triplet, tau):
    """Bearing of a far target in the horizontal plane, the paper's eq. 2.1: asin(c tau / (a cos pitch)).

    tau : (...), mean delay, s, NaN where none was measured. Returns (...), radians, NaN there.
    Raises ValueError for a delay longer than sound needs along the line: no target makes it.
    """
    longest = triplet.spacing * np.cos(triplet.pitch) / triplet.sound_speed
    missing = np.isnan(tau)
    sine = require_between("tau", np.where(missing, 0, tau), -longest, longest) / longest
    return np.where(missing, np.nan, np.arcsin(sine))


def foreshortening(triplet, bearing):
    """cos² of the angle between the target and the plane across the line: 1 - cos²(pitch) sin²(bearing).

    bearing : (...), radians, of a target in the horizontal plane. Returns (...).
    Raises ValueError on the array axis, where the line has no width and curvature tells no range.
    """
    result = 1 - (np.cos(triplet.pitch) * np.sin(bearing)) ** 2
    if np.any(result < ON_AXIS):
        raise ValueError("bearing must be at least 0.06 degrees off the array axis, which tells no range")
    return result


def displacement_toward(triplet, bearing):
    """b, the displacement of H2 towards the target, the paper's eq. 2.3: the displacement along `direction`.

    bearing : (...), radians. Returns (...), m.
    """
    in_body_axes = direction(bearing) @ array_axes(triplet).T
    return np.sum(in_body_axes * np.asarray(triplet.displacement), axis=-1)


def range_from_delays(triplet, tau, eps):
    """Range of a target in the horizontal plane, the paper's eq. 2.2, mended.

    R = a² (1 - cos²(pitch) sin²(bearing)) / (c eps - 2 b)
    tau, eps : (...), s, of `mean_and_difference`. Returns (...), m: infinite where no curvature is left,
    NaN where the wave bends the wrong way, as no target in front of the array can make it.
    Mended twice. The paper has + 2 b: with the displacement counted as actual minus nominal the sign is
    minus. And its numerator a² cos²(pitch) cos²(bearing) leaves out the a² sin²(pitch) by which a pitched
    line is longer across the wave. Raises ValueError for a target on the array axis.
    """
    return _in_front(1.0, curvature_from_delays(triplet, tau, eps))


def curvature_from_delays(triplet, tau, eps):
    """1 / R of either sign, (c eps - 2 b) / (a² foreshortening), 1/m: what may be averaged.

    tau, eps and errors as in `range_from_delays`. Returns (...); below 0 for no target in front.
    """
    bearing = bearing_from_delay(triplet, tau)
    excess = triplet.sound_speed * np.asarray(eps) - 2 * displacement_toward(triplet, bearing)
    return excess / (triplet.spacing**2 * foreshortening(triplet, bearing))


def range_from_delays_as_printed(triplet, tau, eps):
    """The paper's eq. 2.2 as printed: a² cos²(pitch) cos²(bearing) / (c eps + 2 b), m. Else as mended."""
    bearing = bearing_from_delay(triplet, tau)
    foreshortening(triplet, bearing)
    excess = triplet.sound_speed * np.asarray(eps) + 2 * displacement_toward(triplet, bearing)
    return _in_front((triplet.spacing * np.cos(triplet.pitch) * np.cos(bearing)) ** 2, excess)


def estimated_range(actual, assumed, target):
    """The range read by someone who believes in `assumed` while the hydrophones are as in `actual`.

    actual, assumed : Triplet; target : (..., 3), m. Returns (...), m, as `range_from_delays`.
    """
    return range_from_delays(assumed, *mean_and_difference(*arrival_delays(actual, target)))


def displacement_ratio(triplet, target_range, bearing):
    """q, how much of the wave's bend an ignored displacement adds: 2 b R / (a² foreshortening).

    target_range : (...), m; bearing : (...), radians. Returns (...): -1 means that the bend is gone.
    """
    width = triplet.spacing**2 * foreshortening(triplet, bearing)
    return 2 * displacement_toward(triplet, bearing) * require_positive("target_range", target_range) / width


def first_order_error(ratio):
    """Relative range error to first order in the ignored displacement: -q."""
    return -np.asarray(ratio, dtype=float)


def closed_form_error(ratio):
    """Relative range error from an ignored displacement: -q / (1 + q).

    Infinite at q = -1 (no curvature left), NaN below (the target seems to be behind).
    """
    return _in_front(1.0, 1 + np.asarray(ratio, dtype=float)) - 1


def ranging_error_table(triplet, ranges, bearings, displacements):
    """The paper's table 1: the range error when a displacement of H2 is ignored.

    triplet : the array as its user believes it to be
    ranges : (r,), m; bearings : (p,), radians; displacements : (d,), m, tried along each axis in turn
    Returns an ErrorTable of arrays (r, d, 3, p).
    """
    ranges = require_shape("ranges", ranges, (None,))[:, None, None, None]
    bearings = require_shape("bearings", bearings, (None,))
    displacements = require_shape("displacements", displacements, (None,))
    moved = displacements[:, None, None, None] * np.eye(3)[:, None, :] + np.asarray(triplet.displacement)
    actual = replace(triplet, displacement=moved)
    exact = estimated_range(actual, triplet, target_at(ranges, bearings)) / ranges - 1
    ignored = replace(triplet, displacement=moved - np.asarray(triplet.displacement))
    ratio = displacement_ratio(ignored, ranges, bearings)
    return ErrorTable(exact, first_order_error(ratio), closed_form_error(ratio))


def curvature_jitter(delay_jitter, noise_ratio):
    """Standard deviation of eps from that of either delay: sqrt((6 + 2 rho) / (2 + rho)) sigma.

    delay_jitter : (...), s, of tau12 and of tau23; noise_ratio : (...), rho = noise / signal power
    Mended: the paper has sqrt(2) sigma. The noise of H2 enters the two delays with opposite signs, so
    they correlate by -1 / (2 + rho) and their difference is noisier, up to sqrt(3) sigma for little noise.
    """
    ratio = require_not_negative("noise_ratio", noise_ratio)
    return np.asarray(delay_jitter) * np.sqrt((6 + 2 * ratio) / (2 + ratio))


def range_jitter(triplet, target_range, bearing, eps_jitter):
    """Relative standard deviation of range from that of eps: c R sigma_eps / (a² foreshortening).

    target_range : (...), m; bearing : (...), radians; eps_jitter : (...), s. Returns (...), 1 is 100 %.
    To first order; it grows with range.
    """
    width = triplet.spacing**2 * foreshortening(triplet, bearing)
    target_range = require_positive("target_range", target_range)
    return triplet.sound_speed * target_range * np.asarray(eps_jitter) / width


def average_of_range(curvature):
    """The mean of 1 / curvature, the wrong average: one sample near zero can outweigh all the others.

    curvature : (..., n), in units of 1 / length; samples of either sign are averaged as they come.
    Returns (...).
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.mean(1 / require_finite("curvature", curvature), axis=-1)


def range_of_average(curvature):
    """1 / the mean of curvature (..., n), the right average (...); infinite for a mean of 0, NaN below it."""
    return _in_front(1.0, np.mean(require_finite("curvature", curvature), axis=-1))


def vertical_beamwidth(height, frequency, sound_speed=1500.0):
    """Angle from the peak to the first null of a vertical line hydrophone, the paper's eq. 2.5, radians.

    height : h, m; frequency : Hz; sound_speed : m/s. asin(c / (f h)).
    Raises ValueError for a line shorter than one wavelength, whose beam has no null.
    """
    wavelengths = require_positive("height", height) * require_positive("frequency", frequency)
    wavelengths = wavelengths / require_positive("sound_speed", sound_speed)
    if np.any(wavelengths < 1):
        raise ValueError(f"height must be at least one wavelength, but {np.min(wavelengths):g} was given")
    return np.arcsin(1 / wavelengths)


def vertical_pattern(elevation, height, frequency, sound_speed=1500.0):
    """Power response (...) of a vertical line of that height to an elevation (...), radians; 1 at 0."""
    wavelengths = require_positive("height", height) * require_positive("frequency", frequency) / sound_speed
    return np.sinc(wavelengths * np.sin(elevation)) ** 2


def pulled_delay(target_delay, unwanted_delay, power_share):
    """The delay measured with an unwanted source near by, the paper's eqs. 4.22-4.23: a weighted mean.

    target_delay, unwanted_delay : (...), s; power_share : (...), p = P_U / (P_U + P_T), 0 to 1
    Good while the delays differ by much less than a quarter period; see `pulled_delay_phasor`.
    """
    share = require_between("power_share", power_share, 0, 1)
    return np.asarray(target_delay) - share * (np.asarray(target_delay) - np.asarray(unwanted_delay))


def pulled_delay_phasor(target_delay, unwanted_delay, power_share, centre_frequency):
    """The delay at which the sum of two sinusoidal discriminator curves is zero.

    x = x_T + arg(P_T + P_U exp(j 2 pi f0 (x_U - x_T))) / (2 pi f0)
    As `pulled_delay`, for delays that differ by less than half a period, 1 / (2 f0).
    centre_frequency : f0, Hz
    Raises ValueError for delays further apart, where the answer is ambiguous.
    """
    share = require_between("power_share", power_share, 0, 1)
    angular = 2 * np.pi * require_positive("centre_frequency", centre_frequency)
    apart = np.asarray(unwanted_delay) - np.asarray(target_delay)
    require_between("unwanted_delay - target_delay", apart, -np.pi / angular, np.pi / angular)
    return np.asarray(target_delay) + np.angle(1 - share + share * np.exp(1j * angular * apart)) / angular


def _in_front(numerator, denominator):
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(denominator < 0, np.nan, numerator / np.abs(denominator))
