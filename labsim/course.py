"""The course of a vessel from its bearing and its range ratio, seen from one place that does not move.

Bearings alone give the course of a vessel only while it keeps its speed. When the ratio M_k = r_k / r_0
of its range now to its range at the start is known as well, the points M_k (cos theta_k, sin theta_k) draw
its path to an unknown scale, and the course is the direction of a line, at whatever speed the vessel runs
along it (Dong, Guo, Xu and Yan, Journal of Applied Acoustics 2020). Bearing and course are measured alike,
in radians from the x axis towards the y axis; the observer is at the origin.
"""

from dataclasses import dataclass

import numpy as np

from labsim.arguments import (
    require_between,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
)
from labsim.metrics import angle_difference
from labsim.motion import require_increasing, speed_profile_track

CACHED_NUMBERS = 12_000


@dataclass(frozen=True)
class Passage:
    """A vessel on a straight course, at constant speed or accelerating for a while; the paper's section 3.

    initial_range : m; initial_bearing, course : radians; speed : at the start, m/s; duration, frame : s
    acceleration : m/s^2, from accelerate_from for accelerate_for seconds (0.01 in the paper's second scene)
    bearing_std : radians; ratio_std : of the range ratio (the paper's Monte Carlo runs)
    Raises ValueError for values outside their range and for a vessel that would come to run backwards.
    """

    initial_range: float = 10e3
    initial_bearing: float = np.pi / 3
    course: float = np.pi
    speed: float = 5.0
    acceleration: float = 0.0
    accelerate_from: float = 300.0
    accelerate_for: float = 600.0
    duration: float = 1200.0
    frame: float = 1.024
    bearing_std: float = np.radians(0.5)
    ratio_std: float = 0.05

    def __post_init__(self):
        for name in ("initial_range", "speed", "duration", "frame", "bearing_std", "ratio_std"):
            require_positive(name, getattr(self, name))
        for name in ("initial_bearing", "course"):
            require_between(name, getattr(self, name), -2 * np.pi, 2 * np.pi)
        require_positive("accelerate_for", self.accelerate_for)
        require_not_negative("accelerate_from", self.accelerate_from)
        if self.acceleration:
            require_between("accelerate_from", self.accelerate_from, 0, self.duration)
        lowest = -self.speed / self.accelerate_for
        require_between("acceleration", self.acceleration, lowest, 1.0)
        require_between("frame", self.frame, 1e-3, self.duration / 2)

    @property
    def time(self):
        """Start of every frame (K,), s."""
        return np.arange(np.ceil(self.duration / self.frame)) * self.frame

    @property
    def track(self):
        """The vessel's path, a labsim.motion.Track."""
        begin, end = self.accelerate_from, self.accelerate_from + self.accelerate_for
        time = np.array([0.0, begin, end, end + self.duration])
        speed = self.speed + self.acceleration * np.clip(time - begin, 0, self.accelerate_for)
        first = 1 if begin == 0 else 0
        start = self.initial_range * np.array([np.cos(self.initial_bearing), np.sin(self.initial_bearing)])
        return speed_profile_track(start, self.course, time[first:], speed[first:])


def bearing_and_range(track, time, clearance=16.0):
    """Where a vessel is, seen from the origin.

    track : labsim.motion.Track; time : (K,), s, increasing
    clearance : how near the vessel may come, m (half the length of the paper's array)
    Returns bearing (K,), radians, unwrapped, and range (K,), m.
    Raises ValueError for a vessel that passes through the array, also between two times.
    """
    position = track.position(require_increasing("time", time))
    step = np.diff(position, axis=0)
    length = np.maximum(np.sum(step**2, axis=-1), 1e-12)
    nearest = np.clip(-np.sum(position[:-1] * step, axis=-1) / length, 0, 1)
    closest = np.min(np.linalg.norm(position[:-1] + nearest[:, None] * step, axis=-1))
    if closest < clearance:
        raise ValueError(
            f"track must stay at least {clearance:g} m away from the array, "
            f"but it comes within {closest:.3g} m"
        )
    return np.unwrap(np.arctan2(position[:, 1], position[:, 0])), np.linalg.norm(position, axis=-1)


def bearing_and_ratio(passage):
    """True bearing and range ratio of a Passage at every frame, (K,) each; raises as `bearing_and_range`."""
    bearing, distance = bearing_and_range(passage.track, passage.time)
    return bearing, distance / distance[0]


def simulate_observations(rng, bearing, ratio, bearing_std, ratio_std, trials):
    """Noisy bearings and range ratios as in the paper's Monte Carlo runs; the first ratio is 1 by definition.

    rng : numpy.random.Generator; bearing, ratio : (K,), true; bearing_std : radians
    Returns bearing (trials, K) and ratio (trials, K).
    """
    shape = (trials, bearing.size)
    noisy = ratio + ratio_std * rng.standard_normal(shape)
    noisy[:, 0] = 1.0
    return bearing + bearing_std * rng.standard_normal(shape), noisy


def mean_bearing_rate(bearing, frame):
    """Mean absolute change of bearing per second: Dong et al. 2020, section 3, before fig. 8.

    bearing : (..., K), radians; frame : s. Returns (...), radians per second.
    """
    return np.mean(np.abs(angle_difference(bearing[..., 1:], bearing[..., :-1])), axis=-1) / frame


def bearings_only_course(time, bearing, running=True):
    """Course from bearings alone, all of them referred to the first: exact only at constant speed.

    With D = theta - theta_0 the motion obeys sin D = t (u cos D - w sin D), where u and w are the speed
    across and along the first line of sight over the first range; least squares in (u, w), then
    course = theta_0 + atan2(u, w). The paper compares with its reference [5] and does not print that
    equation; this is one reading of it, `free_bearings_only_course` the other.
    time : (K,), s; bearing : (..., K), radians
    running : estimates from the first 1, 2, ... K bearings, (..., K), or from all, (..., 1)
    Returns course, radians in [-pi, pi); NaN where there is nothing to go by, as for a constant bearing.
    """
    time, turn, first = _bearings(time, bearing)
    cosine, sine = np.cos(turn), np.sin(turn)
    return _course_of_fit(first, _moments(running, time * cosine, -time * sine, sine))


def free_bearings_only_course(time, bearing, running=True):
    """Course from bearings alone with the first line of sight left free: sin D (1 + w t) = cos D (b + u t).

    Like `bearings_only_course`, but the noise of the first bearing does not tilt the whole estimate: the
    offset b takes it up. Arguments and result as there; NaN before the third bearing.
    """
    time, turn, first = _bearings(time, bearing)
    cosine, sine = np.cos(turn), np.sin(turn)
    moments = _without_first(_moments(running, cosine, time * cosine, -time * sine, sine))
    course = _course_of_fit(first, moments)
    if running:
        course[..., :2] = np.nan
    return course


def paper_course(bearing, ratio, bearing_std, ratio_std, running=True):
    """The paper's estimator: asymptotically unbiased least squares, Dong et al. 2020, eqs. 14-24.

    Every k gives a_k . gamma = 0 with a_k = (cos theta_0 - M_k cos theta_k, M_k sin theta_k - sin theta_0)
    and gamma = (sin phi, cos phi) in place of (tan phi, 1). Noise adds W to A = sum a a^T on average, and
    the gamma that minimises gamma A gamma at fixed gamma W gamma is the eigenvector of A gamma = lambda W
    gamma with the smallest lambda: two by two, in closed form.
    bearing : (..., K), radians; ratio : (..., K), the first is 1; bearing_std : radians
    running : estimates from the first 1, 2, ... K observations, (..., K), or from all, (..., 1)
    Returns course, radians in [-pi, pi), NaN at k = 0 and for a vessel that lies still.
    Raises ValueError for shapes that differ, values not finite, standard deviations not above 0.
    """
    direction, ratio = _observations(bearing, ratio, bearing_std, ratio_std)
    equation = _from_first(direction, ratio)
    noise = _independent_noise(direction, ratio, bearing_std, ratio_std)
    *moments, n = _sums(running, *_products(equation), _after_first(np.ones(ratio.shape[-1])))
    noise = _sums(running, *noise)
    shared = _first_bearing_noise(direction, bearing_std)
    axis = _least_eigenvector_axis(moments, [w + n * s for w, s in zip(noise, shared, strict=True)])
    return resolve_course(axis, direction, ratio, running)


def centred_course(bearing, ratio, bearing_std, ratio_std, running=True):
    """Direction of the straight line through the points M_k (cos theta_k, sin theta_k), tied to none of them.

    The paper ties the line to its first point; here the mean takes that place, so no single bearing counts
    more than another, and the points may carry any common scale: plain delays serve as well as ratios.
    Arguments and result as for `paper_course`, but ratio and ratio_std may be to any common scale.
    """
    direction, ratio = _observations(bearing, ratio, bearing_std, ratio_std)
    radial, across = _noise_shapes(direction, ratio)
    ones = np.ones(ratio.shape)
    (xx, xy), (_, yy) = _without_first(_moments(running, ones, -ratio * direction[0], ratio * direction[1]))
    radial, across = _sums(running, *radial), _sums(running, *across)
    spread = [bearing_std**2 * w + ratio_std**2 * m for w, m in zip(across, radial, strict=True)]
    return resolve_course(_least_eigenvector_axis((xx, xy, yy), spread), direction, ratio, running)


def correlated_error_course(bearing, ratio, bearing_std, ratio_std, running=True):
    """The paper's equations weighted for the error of the first bearing, which they all share.

    The residuals have the covariance V I + g^2 sigma^2 1 1^T with g = cos(theta_0 - phi); its inverse is
    that of a rank-one change. V and g are taken at the paper's estimate, then once more at the improved one.
    Arguments, result and errors as for `paper_course`.
    """
    direction, ratio = _observations(bearing, ratio, bearing_std, ratio_std)
    equation = _from_first(direction, ratio)
    noise = _independent_noise(direction, ratio, bearing_std, ratio_std)
    xx, xy, yy, x, y, n = _sums(
        running, *_products(equation), *equation, _after_first(np.ones(ratio.shape[-1]))
    )
    noise, shared = _sums(running, *noise), _first_bearing_noise(direction, bearing_std)
    axis = _least_eigenvector_axis((xx, xy, yy), [w + n * s for w, s in zip(noise, shared, strict=True)])
    for _ in range(2):
        common = _quadratic(shared, axis)
        with np.errstate(invalid="ignore", divide="ignore"):
            kappa = common / (_quadratic(noise, axis) / n + n * common)
            moments = (xx - kappa * x * x, xy - kappa * x * y, yy - kappa * y * y)
            spread = [(1 - kappa) * w + (n - kappa * n**2) * s for w, s in zip(noise, shared, strict=True)]
        axis = _least_eigenvector_axis(moments, spread)
    return resolve_course(axis, direction, ratio, running)


def all_courses(time, bearing, ratio, bearing_std, ratio_std, running=True):
    """The five estimates by name: paper, centred, correlated, and of bearings only free and anchored.

    Arguments and results as for each of them. Trials are taken a few at a time: with work space that stays in
    the processor's cache a hundred of them take half as long.
    """
    few = max(1, CACHED_NUMBERS // np.size(time))
    if np.ndim(bearing) > 1 and len(bearing) > few:
        cuts = [slice(first, first + few) for first in range(0, len(bearing), few)]
        parts = [all_courses(time, bearing[c], ratio[c], bearing_std, ratio_std, running) for c in cuts]
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    observed = (bearing, ratio, bearing_std, ratio_std, running)
    return {
        "paper": paper_course(*observed),
        "centred": centred_course(*observed),
        "correlated": correlated_error_course(*observed),
        "free": free_bearings_only_course(time, bearing, running),
        "anchored": bearings_only_course(time, bearing, running),
    }


def resolve_course(axis, direction, ratio, running=True):
    """Choose between a course and its opposite: the one along which the points M (cos, sin) have moved.

    The sign of the points' linear trend along the axis serves all quadrants and a constant bearing alike.
    axis : (..., K) or (..., 1), radians modulo pi
    direction : (cos theta, sin theta), (..., K) each; ratio : M (..., K)
    Returns course, of the shape of `axis`, radians in [-pi, pi).
    """
    step = np.arange(ratio.shape[-1], dtype=float)
    x, y = ratio * direction[0], ratio * direction[1]
    n, k, sx, sy, kx, ky = _sums(running, np.ones(step.size), step, x, y, step * x, step * y)
    along = (kx - k * sx / n) * np.cos(axis) + (ky - k * sy / n) * np.sin(axis)
    return angle_difference(axis + np.where(along < 0, np.pi, 0.0), 0)


def resolve_course_by_bearing(axis, bearing, running=True):
    """The paper's rule (section 2.2): a growing bearing means sin(course - theta_0) > 0, a falling one < 0.

    The paper sets a constant bearing apart, and has to: there the rule follows the noise of the bearing.
    bearing : (..., K), radians; axis and result as for `resolve_course`
    """
    step = np.arange(bearing.shape[-1], dtype=float)
    turn = angle_difference(bearing, bearing[..., :1])
    n, k, total, weighted = _sums(running, np.ones(step.size), step, turn, step * turn)
    grows = weighted - k * total / n > 0
    side = np.sin(axis - bearing[..., :1]) > 0
    return angle_difference(axis + np.where(grows == side, 0.0, np.pi), 0)


def course_bound(bearing, ratio, course, bearing_std, ratio_std, running=True):
    """Cramer-Rao bound on the standard deviation of the course for any motion along a straight line.

    The distance run is unknown at every k; what the pair (theta_k, M_k) then says of course and first
    bearing is the one residual M sin(theta - phi) - sin(theta_0 - phi).
    bearing, ratio : (..., K), true; course : radians; bearing_std : radians
    Returns (..., K) or (..., 1), radians; infinite where the course cannot be seen.
    """
    slope, variance, toward = _residual(bearing, ratio, course, bearing_std, ratio_std)
    own, cross, first = (_after_first(term / variance) for term in (slope**2, -slope * toward, toward**2))
    own, cross, first = _sums(running, own, cross, np.broadcast_to(first, own.shape))
    with np.errstate(divide="ignore"):
        return 1 / np.sqrt(np.maximum(own - cross**2 / (first + 1 / bearing_std**2), 0))


def paper_course_std(bearing, ratio, course, bearing_std, ratio_std, running=True):
    """First-order standard deviation of `paper_course`, in two parts that add as squares.

    Arguments as for `course_bound`. Returns (from the later observations, from the first bearing), radians.
    """
    slope, variance, _ = _residual(bearing, ratio, course, bearing_std, ratio_std)
    weight, spread = _sums(running, slope**2, slope**2 * variance)
    first = bearing_std * np.abs(first_bearing_slope(bearing, ratio, course, running))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.sqrt(spread) / weight, first


def first_bearing_slope(bearing, ratio, course, running=True):
    """By how much `paper_course` moves when the first bearing does: cos(theta_0 - phi) sum D / sum D^2.

    D = cos(theta_0 - phi) - M cos(theta - phi) is the slope of each residual. A longer path makes
    this factor small, more observations on it do not: the estimator is not consistent. Arguments as for
    `course_bound`.
    """
    slope, _, toward = _residual(bearing, ratio, course, 0.0, 0.0)
    total, weight = _sums(running, slope, slope**2)
    with np.errstate(invalid="ignore", divide="ignore"):
        return toward * total / weight


def uniform_motion_bound(time, bearing, relative_speed, course, bearing_std, ratio=None, ratio_std=None):
    """Cramer-Rao bound on the course of a vessel known to keep its speed, from bearings or with ratios too.

    Unknown are the first bearing, the speed over the first range, and the course.
    time : (K,), s; bearing : (K,), true, radians; relative_speed : speed / first range, 1/s
    ratio : (K,), true range ratios that are observed too, or None; ratio_std : their standard deviation
    Returns (K,), radians; infinite for the first two observations.
    """
    time = require_increasing("time", time) - time[0]
    run, ones = relative_speed * time, np.ones_like(time)
    x, y = np.cos(bearing[0]) + run * np.cos(course), np.sin(bearing[0]) + run * np.sin(course)
    share = time / time[-1]
    dx = np.array([-np.sin(bearing[0]) * ones, share * np.cos(course), -run * np.sin(course)])
    dy = np.array([np.cos(bearing[0]) * ones, share * np.sin(course), run * np.cos(course)])
    rows = [(x * dy - y * dx) / (x**2 + y**2) / bearing_std]
    if ratio is not None:
        rows.append((x * dx + y * dy) / ratio / ratio_std * (time > 0))
    information = np.cumsum(np.einsum("rik,rjk->kij", rows, rows), axis=0)
    bound = np.full(time.shape, np.inf)
    bound[2:] = np.sqrt(np.linalg.inv(information[2:])[:, 2, 2])
    return bound


def _bearings(time, bearing):
    time = require_increasing("time", time)
    bearing = require_shape("bearing", require_finite("bearing", bearing), time.shape)
    first = bearing[..., :1]
    return (time - time[0]) / (time[-1] - time[0]), angle_difference(bearing, first), first


def _observations(bearing, ratio, bearing_std, ratio_std):
    bearing = require_shape("bearing", require_finite("bearing", bearing), (None,))
    ratio = require_finite("ratio", ratio)
    if ratio.shape != bearing.shape:
        raise ValueError(f"ratio must have the shape of bearing, {bearing.shape}, not {ratio.shape}")
    require_positive("bearing_std", bearing_std)
    require_positive("ratio_std", ratio_std)
    return (np.cos(bearing), np.sin(bearing)), ratio


def _sums(running, *terms):
    if running:
        return [np.cumsum(term, axis=-1) for term in terms]
    return [np.sum(term, axis=-1, keepdims=True) for term in terms]


def _moments(running, *columns):
    """Sums of the products of every two columns, as the rows of a symmetric matrix."""
    places = range(len(columns))
    sums = {(i, j): _sums(running, columns[i] * columns[j])[0] for i in places for j in places[i:]}
    return [[sums[min(i, j), max(i, j)] for j in places] for i in places]


def _without_first(moments):
    """Moments of what is left of the other columns when least squares has fitted the first to them."""
    (pivot, *row), *rest = moments
    return [[value - x * y / pivot for value, y in zip(line, row, strict=True)] for x, *line in rest]


def _course_of_fit(first, moments):
    """The course of the least-squares u and w: `moments` are those of their columns and of the target."""
    (s11, s12, b1), (_, s22, b2), _ = moments
    course = angle_difference(first + np.arctan2(b1 * s22 - b2 * s12, b2 * s11 - b1 * s12), 0)
    return np.where(s11 * s22 - s12**2 > 1e-12 * s11 * s22, course, np.nan)


def _products(pair):
    x, y = pair
    return x * x, x * y, y * y


def _after_first(term):
    result = np.array(term)
    result[..., 0] = 0
    return result


def _from_first(direction, ratio):
    cosine, sine = direction
    return cosine[..., :1] - ratio * cosine, ratio * sine - sine[..., :1]


def _noise_shapes(direction, ratio):
    cosine, sine = direction
    square, product = ratio**2, sine * cosine
    radial = (cosine**2, -product, sine**2)
    return radial, (square * radial[2], square * product, square * radial[0])


def _independent_noise(direction, ratio, bearing_std, ratio_std):
    radial, across = _noise_shapes(direction, ratio)
    return [_after_first(ratio_std**2 * r + bearing_std**2 * a) for r, a in zip(radial, across, strict=True)]


def _first_bearing_noise(direction, bearing_std):
    cosine, sine = (bearing_std * part[..., :1] for part in direction)
    return _products((sine, cosine))


def _quadratic(matrix, course):
    sine, cosine = np.sin(course), np.cos(course)
    return matrix[0] * sine**2 + 2 * matrix[1] * sine * cosine + matrix[2] * cosine**2


def _least_eigenvector_axis(a, w):
    p2, p0 = w[0] * w[2] - w[1] ** 2, a[0] * a[2] - a[1] ** 2
    p1 = a[0] * w[2] + a[2] * w[0] - 2 * a[1] * w[1]
    with np.errstate(invalid="ignore", divide="ignore"):
        smallest = 2 * p0 / (p1 + np.sqrt(np.maximum(p1**2 - 4 * p2 * p0, 0)))
        left = [x - smallest * y for x, y in zip(a, w, strict=True)]
    return -0.5 * np.arctan2(2 * left[1], left[0] - left[2])


def _residual(bearing, ratio, course, bearing_std, ratio_std):
    angle = bearing - course
    toward = np.cos(bearing[..., :1] - course)
    variance = (ratio_std * np.sin(angle)) ** 2 + (ratio * bearing_std * np.cos(angle)) ** 2
    return toward - ratio * np.cos(angle), variance, toward
