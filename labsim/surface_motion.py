"""Position and velocity of a surface vessel from the directions one vector sensor hears.

A direction and a known depth name one point of the surface: the chain direction, position, velocity of
Wu & Hu, "Analysis of surface target motion based on a single vector sensor", Technical Acoustics 29(4),
2010. An error of angle is stretched by the square of the range on its way to a position, and by
1/T on its way to a difference velocity. So positions are fitted first: along a line, as the paper
prints it, or linearly in time, which is what uniform motion means.
"""

from dataclasses import dataclass

import numpy as np

from labsim.arguments import require_positive, require_shape, require_whole
from labsim.vector_sensor import unit_vector

STEPS = 10


@dataclass(frozen=True)
class Motion:
    """An estimated motion: `position` (..., n, 2), m, and `velocity` (..., n, 2), m/s, for each window."""

    position: np.ndarray
    velocity: np.ndarray


def position(azimuth, angle_from_vertical, depth):
    """The point of the surface in a given direction (Wu & Hu 2010, eq. 5).

    azimuth : (...), radians from the x axis towards the y axis
    angle_from_vertical : (...), radians, 0 straight up; the paper calls it elevation
    depth : of the sensor under the surface, m
    Returns (..., 2), m from the point above the sensor; the paper's r_k is this range.
    NaN where the direction is NaN or does not meet the surface (angle_from_vertical not below pi/2).
    Raises ValueError for a depth that is not positive.
    """
    require_positive("depth", depth)
    angle = np.asarray(angle_from_vertical, dtype=float)
    meets = (angle >= 0) & (angle < np.pi / 2)
    horizontal_range = depth * np.tan(np.where(meets, angle, np.nan))
    bearing = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    return horizontal_range[..., None] * bearing


def slant_range(position, depth):
    """Distance from the sensor to points of the surface: (..., 2), m -> (...), m."""
    position = require_shape("position", position, (2,))
    require_positive("depth", depth)
    return np.hypot(np.hypot(position[..., 0], position[..., 1]), depth)


def emission_time(position, time, depth, sound_speed):
    """The time a position belongs to: mid-window less the travel time of the sound.

    The paper neglects both halves of this. The estimate of a window belongs to its middle, and the
    vessel was there slant range / sound speed earlier (up to 0.35 s, 4 m of its path).

    position : (..., n, 2), estimated, m; time : (n,), middle of each window, s
    depth : m; sound_speed : m/s
    Returns (..., n), s; NaN where the position is NaN.
    Raises ValueError for wrong shapes or a depth or sound speed that is not positive.
    """
    position = require_shape("position", position, (None, 2))
    time = require_shape("time", time, (position.shape[-2],))
    return time - slant_range(position, depth) / require_positive("sound_speed", sound_speed)


def difference_velocity(position, window):
    """Velocity as the difference of successive positions (Wu & Hu 2010, eq. 6).

    position : (..., n, 2), m; window : T, s
    Returns (..., n, 2), m/s. The first row is NaN: there is nothing to subtract. (The paper
    sets it to 0, which would count as an estimate in an average.) NaN positions give NaN.
    Raises ValueError for a wrong shape or a window that is not positive.
    """
    position = require_shape("position", position, (None, 2))
    require_positive("window", window)
    velocity = np.full(position.shape, np.nan)
    velocity[..., 1:, :] = np.diff(position, axis=-2) / window
    return velocity


def line_fit(position):
    """The growing least-squares line y = A x + B through the first k positions (Wu & Hu 2010, eq. 7).

    position : (..., n, 2), m; NaN rows are left out of the sums
    Returns A (..., n) and B (..., n), m: the line known at each window. NaN while fewer than two points are
    known. The line takes every error for an error of y; a track along y defeats it.
    Raises ValueError for a wrong shape.
    """
    mean, spread = _growing_moments(position)
    with np.errstate(invalid="ignore", divide="ignore"):
        slope = spread[..., 0, 1] / spread[..., 0, 0]
    return slope, mean[..., 1] - slope * mean[..., 0]


def line_fit_velocity(position, window):
    """The paper's fitted velocity, taken literally: [x_i, A x_i + B], i = k-1, k, put into eq. 6.

    (Wu & Hu 2010, eqs. 6 and 7.) The step of x is still the raw one; the line only decides its direction.

    position : (..., n, 2), m; window : T, s
    Returns (..., n, 2), m/s; the first row is NaN. Raises ValueError as difference_velocity does.
    """
    slope, _ = line_fit(position)
    step = difference_velocity(position, window)[..., 0]
    return np.stack([step, slope * step], axis=-1)


def orthogonal_line_fit(position):
    """The growing line that leaves the least squared distance across it (total least squares).

    The paper's eq. 7 with the errors shared between x and y, so that it turns as the world turns.

    position : (..., n, 2), m; NaN rows are left out
    Returns a point on the line (..., n, 2), m, the mean position, and the direction of the line (..., n),
    radians in (-pi/2, pi/2]. NaN while fewer than two points are known.
    Raises ValueError for a wrong shape.
    """
    mean, spread = _growing_moments(position)
    direction = np.arctan2(2 * spread[..., 0, 1], spread[..., 0, 0] - spread[..., 1, 1]) / 2
    return mean, direction


def orthogonal_fit_velocity(position, window):
    """Successive positions projected on the orthogonal line, put into Wu & Hu 2010, eq. 6.

    position : (..., n, 2), m; window : T, s
    Returns (..., n, 2), m/s; the first row is NaN. Raises ValueError as difference_velocity does.
    """
    _, direction = orthogonal_line_fit(position)
    along = np.stack([np.cos(direction), np.sin(direction)], axis=-1)
    step = difference_velocity(position, window)
    return along * np.sum(along * step, axis=-1, keepdims=True)


def position_precision(position, depth, angle_error):
    """Inverse covariance of a position whose direction is wrong every way across it.

    The error is angle_error * r along the circle and angle_error * r^2 / depth along the
    radius, r the slant range; both at once are (1 - d d' / r^2) / (r angle_error)^2.

    position : (..., 2), d, m; depth : m
    angle_error : (...), standard deviation of the direction, radians
    Returns (..., 2, 2), 1/m^2. Raises ValueError for a wrong shape or values that are not positive.
    """
    position = require_shape("position", position, (2,))
    angle_error = require_positive("angle_error", angle_error)
    distance = slant_range(position, depth)[..., None, None]
    shape = np.eye(2) - position[..., :, None] * position[..., None, :] / distance**2
    return shape / (distance * angle_error[..., None, None]) ** 2


def motion_fit(position, time, precision=None, span=None, centred=False):
    """Uniform motion d(t) = d0 + u t fitted to positions by least squares, anew at each window.

    This is what a fit must do to give a speed: both x and y are linear in time, not in each other.

    position : (..., n, 2), m; NaN rows are left out
    time : (n,) or (..., n), the time each position belongs to, s (see emission_time)
    precision : (..., n, 2, 2), 1/m^2, the weights (see weighted_motion_fit); all alike if None
    span : number of windows in each fit, the latest or, if `centred`, those on both sides; all so far if None
        (an even span is centred at the start of its window)
    Returns a Motion: position and velocity at each window. NaN where fewer than two positions are known, or
    where the span reaches over an end of the record.
    Raises ValueError for shapes that do not match or a span outside 2..n.
    """
    position = require_shape("position", position, (None, 2))
    windows = position.shape[-2]
    time = require_shape("time", time, (windows,))
    precision = np.eye(2) if precision is None else require_shape("precision", precision, (windows, 2, 2))
    known = np.isfinite(position).all(axis=-1) & np.isfinite(time)
    centre = _mean_time(time)
    information, pull = _normal_equations(position, precision, time - centre, known)
    information, pull = _window_sum(information, -3, span, centred), _window_sum(pull, -2, span, centred)
    enough = _window_sum(known.astype(int), -1, span, centred) >= 2
    state = _solve(information, pull, enough)
    return Motion(state[..., :2] + (time - centre)[..., None] * state[..., 2:], state[..., 2:])


def weighted_motion_fit(position, time, depth, angle_error, span=None, centred=False):
    """motion_fit with each position weighted by what it is worth (position_precision).

    The worth depends on the range. Taken at the noisy position itself it would favour errors
    towards the sensor and bend the fit; so it is taken at the track of a first, unweighted
    fit, which is carried on in a straight line where the span leaves the record.

    position : (..., n, 2), m; time : (n,) or (..., n), s; depth : m
    angle_error : scalar or (n,) or (..., n), standard deviation of direction, radians
        (only ratios matter)
    span, centred : as in motion_fit. Returns a Motion; NaN and errors as there.
    """
    track = _carried_on(motion_fit(position, time, None, span, centred), time)
    precision = position_precision(track, depth, angle_error)
    return motion_fit(position, time, precision, span, centred)


def maximum_likelihood_motion(azimuth, angle_from_vertical, time, depth, sound_speed, angle_error):
    """Uniform motion most likely to have given these directions, all windows at once.

    Directions with Gaussian errors, of standard deviation angle_error across them, are compared with those
    of the motion itself: Gauss-Newton in four numbers (a position and a velocity), for all trials together.
    Each step is a weighted motion fit in which weights, errors and emission times are those of the fitted
    track, not of the noisy points.

    azimuth, angle_from_vertical : (..., n), radians; NaN windows are left out
    time : (n,), middle of each window, s; depth : m; sound_speed : m/s
    angle_error : scalar or (n,) or (..., n), radians
    Returns a Motion: position (..., n, 2) at each window, and velocity (..., n, 2), the same in all windows.
    NaN where fewer than two windows are known.
    Raises ValueError for shapes that do not match or values that are not positive.
    """
    azimuth = require_shape("azimuth", azimuth, (None,))
    angle = require_shape("angle_from_vertical", angle_from_vertical, azimuth.shape[-1:])
    require_positive("angle_error", angle_error)
    heard = unit_vector(azimuth, angle)
    points = position(azimuth, angle, depth)
    known = np.isfinite(heard).all(axis=-1)
    emitted = emission_time(points, time, depth, sound_speed)
    centre = _mean_time(emitted)
    state = _whole_fit(points, position_precision(points, depth, angle_error), emitted - centre)
    track = _position_at(state, np.where(np.isfinite(emitted), emitted, time) - centre)
    for _ in range(STEPS):
        emitted = emission_time(track, time, depth, sound_speed)
        track = _position_at(state, emitted - centre)
        seen = np.where(known[..., None], track + _shift_towards(heard, track, depth), np.nan)
        state = _whole_fit(seen, position_precision(track, depth, angle_error), emitted - centre)
    return Motion(track, np.broadcast_to(state[..., None, 2:], track.shape))


def motion_bound(position, time, depth, angle_error, span=None, centred=False):
    """The least error with which directions can give position and velocity (Cramer-Rao).

    For directions with Gaussian errors of standard deviation angle_error, and a motion that is known to be
    uniform. What the level and the Doppler shift say of the range is left out, and so is the dependence of
    the emission time on the unknown motion, a share of speed / sound speed of the bound.

    position : (..., n, 2), true, m; time : (..., n), when the vessel was there, s
    depth : m; angle_error : scalar or (..., n), radians
    span, centred : which windows are used, as in motion_fit
    Returns position_error (..., n), m, and velocity_error (..., n), m/s: root mean squares of the length of
    the error vector at each window. NaN where fewer than two windows are known.
    Raises ValueError for shapes that do not match or values that are not positive.
    """
    position = require_shape("position", position, (None, 2))
    time = require_shape("time", time, position.shape[-2:-1])
    centre = _mean_time(time)
    precision = position_precision(position, depth, angle_error)
    information = _window_sum(_information(precision, time - centre), -3, span, centred)
    enough = _window_sum(np.ones(time.shape, dtype=int), -1, span, centred) >= 2
    spread = _solve(information, np.broadcast_to(np.eye(4), information.shape), enough)
    offset = (time - centre)[..., None, None]
    at_window = np.concatenate([np.broadcast_to(np.eye(2), (*time.shape, 2, 2)), offset * np.eye(2)], axis=-1)
    located = at_window @ spread @ np.swapaxes(at_window, -1, -2)
    return _root_trace(located), _root_trace(spread[..., 2:, 2:])


def along_and_across(vector, heading):
    """Components of horizontal vectors along a heading and to the left of it.

    vector : (..., 2); heading : scalar or (...), radians from the x axis
    Returns (..., 2) in the unit of `vector`: along, across.
    """
    vector = require_shape("vector", vector, (2,))
    x, y = vector[..., 0], vector[..., 1]
    cosine, sine = np.cos(heading), np.sin(heading)
    return np.stack([x * cosine + y * sine, y * cosine - x * sine], axis=-1)


def _growing_moments(position):
    """Mean (..., n, 2) and covariance (..., n, 2, 2) of the first k positions; NaN while fewer than two."""
    position = require_shape("position", position, (None, 2))
    known = np.isfinite(position).all(axis=-1, keepdims=True)
    count = np.cumsum(known, axis=-2)
    position = np.where(known, position, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        centre = np.sum(position, axis=-2, keepdims=True) / count[..., -1:, :]
        offset = np.where(known, position - centre, 0.0)
        mean = np.where(count >= 2, np.cumsum(offset, axis=-2) / count, np.nan)
        square = np.cumsum(offset[..., :, None] * offset[..., None, :], axis=-3) / count[..., None]
    return mean + centre, square - mean[..., :, None] * mean[..., None, :]


def _carried_on(motion, time):
    """The track of a motion at every window: where unknown, straight on from the nearest known window."""
    near = _nearest_known(np.isfinite(motion.position).all(axis=-1))
    time = np.broadcast_to(time, near.shape)
    away = time - np.take_along_axis(time, near, axis=-1)
    place = np.take_along_axis(motion.position, near[..., None], axis=-2)
    return place + away[..., None] * np.take_along_axis(motion.velocity, near[..., None], axis=-2)


def _nearest_known(known):
    """Index (..., n) of the nearest window that is known; 0 where none is."""
    window = np.arange(known.shape[-1])
    before = np.maximum.accumulate(np.where(known, window, -np.inf), axis=-1)
    after = np.flip(np.minimum.accumulate(np.flip(np.where(known, window, np.inf), -1), axis=-1), -1)
    nearest = np.where(window - before <= after - window, before, after)
    return np.where(np.isfinite(nearest), nearest, 0).astype(int)


def _mean_time(time):
    return np.mean(time[np.isfinite(time)]) if np.isfinite(time).any() else 0.0


def _shift_towards(heard, track, depth):
    """How far a point of the surface must move, to first order, to lie where it is heard: (..., 2), m."""
    line = np.concatenate([track, np.full((*track.shape[:-1], 1), float(depth))], axis=-1)
    distance = slant_range(track, depth)[..., None]
    along = np.sum(heard * line, axis=-1, keepdims=True) / distance
    miss = distance * heard - along * line
    return miss[..., :2] - miss[..., 2:] / depth * track


def _position_at(state, offset):
    return state[..., None, :2] + offset[..., None] * state[..., None, 2:]


def _whole_fit(position, precision, offset):
    known = np.isfinite(position).all(axis=-1) & np.isfinite(offset)
    information, pull = _normal_equations(position, precision, offset, known)
    return _solve(information.sum(axis=-3), pull.sum(axis=-2), np.count_nonzero(known, axis=-1) >= 2)


def _normal_equations(position, precision, offset, known):
    """What each window says of (d0, u): information (..., n, 4, 4) and pull (..., n, 4), 0 where unknown."""
    precision = np.where(known[..., None, None], precision, 0.0)
    offset = np.where(known, offset, 0.0)
    pull = np.einsum("...ij,...j->...i", precision, np.where(known[..., None], position, 0.0))
    return _information(precision, offset), np.concatenate([pull, offset[..., None] * pull], axis=-1)


def _information(precision, offset):
    offset = offset[..., None, None]
    upper = np.concatenate([precision, offset * precision], axis=-1)
    return np.concatenate([upper, offset * upper], axis=-2)


def _window_sum(values, axis, span, centred):
    """Sums over the windows of each fit: all so far, or `span` of them; 0 where these leave the record."""
    total = np.cumsum(values, axis=axis)
    if span is None:
        return total
    windows = values.shape[axis]
    span = require_whole("span", span, 2, windows)
    total = np.moveaxis(total, axis, 0)
    sums = np.zeros_like(total)
    first = span // 2 if centred else span - 1
    inside = sums[first : first + windows - span + 1]
    inside[:] = total[span - 1 :]
    inside[1:] -= total[: windows - span]
    return np.moveaxis(sums, 0, axis)


def _root_trace(matrix):
    return np.sqrt(np.trace(matrix, axis1=-2, axis2=-1))


def _solve(information, pull, enough):
    """Solve for each window; NaN where there is not enough to solve for."""
    information = np.where(enough[..., None, None], information, np.eye(4))
    columns = pull if pull.ndim == information.ndim else pull[..., None]
    try:
        state = np.linalg.solve(information, columns)
    except np.linalg.LinAlgError:
        raise ValueError("time must differ between windows, but is the same for all") from None
    state = np.where(enough[..., None, None], state, np.nan)
    return state if pull.ndim == information.ndim else state[..., 0]
