"""Which bearing at one array belongs to which bearing at another: parallax, gates and pairing rules.

Two arrays a short distance apart see one target under almost the same bearing; what differs is the parallax,
which has one sign only and shrinks with range. If the range is known to lie above a minimum, or between two
bounds, the bearing at the second array must lie in a lopsided interval, the gate (Xu, Xia & Fu 2022).
All angles are clockwise positive; theta is the bearing at array 1 minus the bearing of the line from 1 to 2.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.special import ndtr

from labsim.arguments import (
    require_between,
    require_choice,
    require_finite,
    require_interval,
    require_not_negative,
    require_positive,
    require_scalar,
    require_shape,
)
from labsim.metrics import angle_difference

NO_PARTNER, AMBIGUOUS = -1, -2  # in place of the index of a partner
FALSE_ALARM, NOTHING = -3, -4  # in place of the index of a source


@dataclass(frozen=True)
class AttackScenario:
    """Two approaching torpedoes and two leaving boats, heard by two arrays of a moving vessel.

    The values of Xu 2022, sections 1.3 and 2.2: ranges in m and bearings in degrees from array 1 at time 0,
    headings in degrees from north, speeds in m/s. Array 2 lies `baseline` metres behind array 1 on a vessel
    going north. `range_margin` bounds the range: true range times 1 -/+ margin.
    """

    start_range: tuple = (10_000.0, 9_000.0, 12_000.0, 10_000.0)
    bearing_deg: tuple = (90.0, 110.0, 95.0, 120.0)
    heading_deg: tuple = (-63.7, -46.2, 60.0, -135.0)
    speed: tuple = (30.0, 30.0, 10.0, 10.0)
    baseline: float = 800.0
    own_speed: float = 10.0
    error_deg: float = 3.0
    minimum_range: float = 7_000.0
    range_margin: float = 0.5
    period: float = 3.0
    duration: float = 360.0
    false_alarms: float = 0.0
    detection_probability: float = 1.0
    false_alarm_sector_deg: tuple = (0.0, 180.0)
    false_alarm_range: tuple = (5_000.0, 15_000.0)

    def __post_init__(self):
        sources = len(self.start_range)
        for name in ("start_range", "bearing_deg", "heading_deg", "speed"):
            require_shape(name, require_finite(name, getattr(self, name)), (sources,))
        require_positive("start_range", self.start_range)
        require_not_negative("speed", self.speed)
        for name in ("baseline", "error_deg", "minimum_range", "period", "duration"):
            require_positive(name, require_scalar(name, getattr(self, name)))
        for name in ("own_speed", "false_alarms"):
            require_not_negative(name, require_scalar(name, getattr(self, name)))
        for name, most in (("detection_probability", 1), ("range_margin", 0.99)):
            require_between(name, require_scalar(name, getattr(self, name)), 0, most)
        require_interval("false_alarm_sector_deg", self.false_alarm_sector_deg)
        require_interval("false_alarm_range", self.false_alarm_range, low=0)
        if not self.minimum_range > self.baseline:
            raise ValueError(
                f"minimum_range must be above the baseline, {self.baseline:g} m, "
                f"but {self.minimum_range:g} was given"
            )

    @property
    def error(self):
        """Standard deviation of one bearing at either array, radians."""
        return np.radians(self.error_deg)

    @property
    def time(self):
        """Times of the scans, s, (scans,)."""
        return np.arange(0.0, self.duration + self.period / 2, self.period)


@dataclass(frozen=True)
class Scans:
    """What two arrays report: bearings, NaN where there is none, and where each came from.

    first, second : (..., n) and (..., m), bearings from north, radians
    first_source, second_source : the index of the source, FALSE_ALARM, or NOTHING where there is no bearing
    first_range : (..., n), the range that a bearing of array 1 is believed to have, m
    """

    first: np.ndarray
    second: np.ndarray
    first_source: np.ndarray
    second_source: np.ndarray
    first_range: np.ndarray


def parallax(theta, target_range, baseline):
    """How far the bearing turns from array 1 to array 2 (Xu 2022, eqs. 1-2 and 5-6, without the case split).

    theta : baseline bearing at array 1, radians; target_range : from array 1, m, may be infinite
    baseline : distance of the arrays, m. Returns radians, with the sign of theta; the printed angle ABC is
    pi - |theta + parallax|. Raises ValueError for a baseline or a range not above 0.
    """
    require_positive("baseline", baseline)
    target_range = _require_range("target_range", target_range)
    return np.arctan2(baseline * np.sin(theta), target_range - baseline * np.cos(theta))


def bearing_gate(theta, first_error, second_error, baseline, low, up=np.inf):
    """Limits of the baseline bearing at array 2 for a range between `low` and `up` (Xu 2022, eqs. 3, 7-13).

    theta : baseline bearing at array 1, radians; first_error, second_error : error bounds, radians
    low, up : bounds of the range from array 1, m; up may be infinite: the minimum-range gate
    Returns (lower, upper), radians, each of the shape of the arguments, not wrapped.
    Mended: the paper has one formula for each side, which are wrong within `first_error` of the baseline.
    Raises ValueError for ranges that cross, or so near array 2 that the target may be on any side of it.
    """
    left = np.asarray(theta, dtype=float) - first_error
    right = np.asarray(theta, dtype=float) + first_error
    _require_gate(left, right, first_error, second_error, baseline, low, up)
    lower = left + np.minimum(parallax(left, low, baseline), parallax(left, up, baseline)) - second_error
    upper = right + np.maximum(parallax(right, low, baseline), parallax(right, up, baseline)) + second_error
    return lower, upper


def printed_gate(theta, first_error, second_error, baseline, low, up=np.inf):
    """The gate exactly as printed: eqs. 1-3 and 8-13 for theta <= 0, eqs. 5-7 (and the mirror of 8-13) above.

    Arguments and result as for `bearing_gate`. Kept for comparison: for |theta| < first_error, and within
    first_error of the far end of the baseline, it can exclude the target's own bearing.
    """
    side = np.where(np.asarray(theta) > 0, 1.0, -1.0)
    size = np.abs(theta)
    outer = np.pi - _angle_abc(size + first_error, low, baseline) + second_error
    if np.all(np.isinf(up)):
        inner = size - first_error - second_error
    else:
        inner = np.pi - _angle_abc(size - first_error, up, baseline) - second_error
    return np.where(side > 0, inner, -outer), np.where(side > 0, outer, -inner)


def gate_size(theta, first_error, second_error, baseline, low):
    """Width of the minimum-range gate, radians (Xu 2022, section 1.2). Arguments as for `bearing_gate`."""
    lower, upper = bearing_gate(theta, first_error, second_error, baseline, low)
    return upper - lower


def gate_size_extremes(first_error, second_error, baseline, low):
    """Widest and narrowest minimum-range gate for first_error <= theta <= pi - first_error.

    Returns (largest, theta_largest, smallest, theta_smallest), radians. Parallax is largest where array 2
    sees the circle of radius `low` around array 1 at a right angle: cos(theta + first_error) = baseline/low.
    Raises ValueError as `bearing_gate` does, and for `low` too near the baseline to have such a theta.
    """
    _require_gate(-first_error, first_error, first_error, second_error, baseline, low, np.inf)
    if baseline > low * np.cos(2 * first_error):
        raise ValueError(f"low must be above {baseline / np.cos(2 * first_error):g} m, but {low:g} was given")
    margin = 2 * first_error + 2 * second_error
    theta_largest = np.arccos(baseline / low) - first_error
    return np.arcsin(baseline / low) + margin, theta_largest, margin, np.pi - first_error


def gate_coverage(theta, target_range, first_sigma, second_sigma, bounds, baseline, low, up=np.inf):
    """Probability that the target's own bearing at array 2 lies in its gate, for Gaussian errors.

    theta : true baseline bearing at array 1, radians; target_range : true range, m
    first_sigma, second_sigma : standard deviations, radians; bounds : error bound of the gate in sigmas
    low, up : the range bounds of the gate, which need not contain target_range
    Returns probabilities: each edge of the gate moves with the error of bearing 1, a little faster or slower
    because the parallax moves too (its slope), and bearing 2 misses it by a Gaussian.
    """
    require_positive("first_sigma", first_sigma)
    require_positive("second_sigma", second_sigma)
    bounds = require_not_negative("bounds", bounds)
    lower, upper = bearing_gate(theta, bounds * first_sigma, bounds * second_sigma, baseline, low, up)
    own = theta + parallax(theta, target_range, baseline)
    left, right = theta - bounds * first_sigma, theta + bounds * first_sigma
    lower_slope = _slope(left, np.where(np.sin(left) > 0, up, low), baseline)
    upper_slope = _slope(right, np.where(np.sin(right) > 0, low, up), baseline)
    below = ndtr((lower - own) / np.hypot(first_sigma * lower_slope, second_sigma))
    return ndtr((upper - own) / np.hypot(first_sigma * upper_slope, second_sigma)) - below


def source_positions(scenario, time):
    """Positions relative to array 1, north and east: (..., sources, 2), m, for times (...), s."""
    velocity = _north_east(scenario.speed, scenario.heading_deg) - np.array([scenario.own_speed, 0.0])
    start = _north_east(scenario.start_range, scenario.bearing_deg)
    return start + velocity * require_finite("time", time)[..., None, None]


def true_bearings(scenario, time):
    """True bearings and ranges.

    Returns (first, second, range): bearings from north at array 1 and array 2, radians, and the range from
    array 1, m, each (..., sources) for times (...), s.
    """
    north, east = np.moveaxis(source_positions(scenario, time), -1, 0)
    return np.arctan2(east, north), np.arctan2(east, north + scenario.baseline), np.hypot(east, north)


def simulate_scans(rng, scenario, time, trials):
    """Noisy bearings of both arrays with misses and false alarms.

    rng : numpy.random.Generator; time : (scans,), s; trials : number of runs
    Returns Scans with arrays (trials, scans, n): first the sources in order, then false alarms. A false alarm
    of array 1 is believed to be at a range drawn from `scenario.false_alarm_range`.
    """
    first, second, target_range = true_bearings(scenario, time)
    shape = (trials, *target_range.shape)
    first, first_source = _observe(rng, scenario, np.broadcast_to(first, shape))
    second, second_source = _observe(rng, scenario, np.broadcast_to(second, shape))
    extra = rng.uniform(*scenario.false_alarm_range, first.shape)
    extra[..., : shape[-1]] = target_range
    return Scans(first, second, first_source, second_source, extra)


def scan_gates(scenario, scans, bounds, kind="minimum range"):
    """Gates in true bearing for every bearing of array 1 (Xu 2022, eqs. 4 and 14).

    bounds : error bound in sigmas; kind : "minimum range" or "range bounds"
    Returns (lower, upper), radians from north, each (..., n).
    """
    require_choice("kind", kind, ("minimum range", "range bounds"))
    low, up = scenario.minimum_range, np.inf
    if kind == "range bounds":
        low, up = (scans.first_range * (1 + sign * scenario.range_margin) for sign in (-1, 1))
    bound = bounds * scenario.error
    lower, upper = bearing_gate(scans.first - np.pi, bound, bound, scenario.baseline, low, up)
    return lower + np.pi, upper + np.pi


def in_gate(gate, second):
    """Which bearings of array 2, (..., m), lie in which gate, (..., n): (..., n, m) of bool."""
    lower, upper = (edge[..., :, None] for edge in gate)
    with np.errstate(invalid="ignore"):
        offset = np.abs(angle_difference(np.asarray(second)[..., None, :], (lower + upper) / 2))
        return offset <= (upper - lower) / 2


def unique_candidate(allowed):
    """Pair only where the gate holds exactly one bearing (Xu 2022, section 1).

    allowed : (..., n, m) of bool, from `in_gate`
    Returns (..., n): index of the partner, NO_PARTNER for an empty gate, AMBIGUOUS for several.
    """
    allowed = np.asarray(allowed, dtype=bool)
    count = np.count_nonzero(allowed, axis=-1)
    chosen = _first_true(allowed)
    return np.where(count > 1, AMBIGUOUS, chosen)


def nearest_bearing(first, second, allowed=True):
    """Pair with the nearest bearing, each on its own: two may claim the same partner.

    first, second : (..., n) and (..., m), radians; allowed : (..., n, m), where pairs may form
    Returns (..., n): index of the partner, or NO_PARTNER. With gate centres as `first`: nearest gate centre.
    """
    cost = squared_difference(first, second, allowed)
    if cost.shape[-1] == 0:
        return np.full(cost.shape[:-1], NO_PARTNER)
    return np.where(np.isfinite(cost.min(axis=-1)), np.argmin(cost, axis=-1), NO_PARTNER)


def squared_difference(first, second, allowed=True):
    """Squared bearing differences, (..., n, m), rad^2; infinite where a bearing is absent or not allowed."""
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    square = angle_difference(second[..., None, :], first[..., :, None]) ** 2
    return np.where(np.isnan(square) | ~np.asarray(allowed, dtype=bool), np.inf, square)


def global_assignment(cost, null_cost=np.inf):
    """One-to-one pairing of least total cost (the assignment problem), scan by scan.

    cost : (..., n, m), not negative, infinite where a pair is forbidden
    null_cost : cost of leaving one bearing of array 1 alone; infinite: as few as possible are left alone
    Returns (..., n): index of the partner, or NO_PARTNER. Raises ValueError for NaN in cost.
    """
    cost = np.asarray(cost, dtype=float)
    if np.any(np.isnan(cost)) or np.any(cost < 0):
        raise ValueError("cost must not be negative or NaN; use infinity for a forbidden pair")
    require_shape("cost", cost, (None, None))
    *batch, n, m = cost.shape
    finite = cost[np.isfinite(cost)]
    alone = min(float(null_cost), 1 + 2 * n * finite.max(initial=0.0))
    extended = np.concatenate([cost, np.full((*batch, n, n), alone)], axis=-1)
    table = np.where(np.isfinite(extended), extended, 2 * n * alone + 1)
    scans = table.reshape(int(np.prod(batch)), n, m + n)
    partner = np.array([linear_sum_assignment(scan)[1] for scan in scans], dtype=int).reshape(*batch, n)
    return np.where(partner < m, partner, NO_PARTNER)


def null_pairing_cost(spread, detection_probability, false_alarm_density):
    """Cost, rad^2, beyond which a pair is less likely than a miss: the likelihood-ratio null.

    A pair whose squared difference is d^2 has the likelihood P_D exp(-d^2 / 2 s^2) / (sqrt(2 pi) s) against
    (1 - P_D) times the density of false alarms; equality gives d^2.
    spread : s, radians; false_alarm_density : per radian
    """
    spread = require_positive("spread", spread)
    require_between("detection_probability", detection_probability, 0, 1)
    require_positive("false_alarm_density", false_alarm_density)
    if not 0 < detection_probability < 1:
        return np.inf if detection_probability else 0.0
    odds = detection_probability / (1 - detection_probability)
    peak = 1 / (np.sqrt(2 * np.pi) * spread)
    return np.maximum(2 * spread**2 * np.log(odds * peak / false_alarm_density), 0.0)


def track_cost(first, second):
    """Mean squared bearing difference between whole tracks, (..., n, m), rad^2; infinite if never both seen.

    first, second : (..., scans, n) and (..., scans, m), one track a column
    """
    square = squared_difference(first, second)
    seen = np.isfinite(square)
    count = np.count_nonzero(seen, axis=-3)
    total = np.sum(np.where(seen, square, 0.0), axis=-3)
    return np.where(count > 0, total / np.maximum(count, 1), np.inf)


def pairing_rates(partner, scans):
    """How often pairing is right, per bearing of array 1 that comes from a source.

    partner : (..., n), from a pairing rule
    Returns a dict of rates that sum to 1: correct (own bearing), false (another one), missed (left alone
    though array 2 heard it), ambiguous (undecided), and null (rightly left alone).
    """
    source = scans.first_source
    if scans.second_source.shape[-1] == 0:
        given = np.full(partner.shape, NOTHING)
    else:
        given = np.take_along_axis(scans.second_source, np.maximum(partner, 0), axis=-1)
    heard = np.any(scans.second_source[..., None, :] == source[..., :, None], axis=-1)
    real, alone, undecided = source >= 0, partner == NO_PARTNER, partner == AMBIGUOUS
    paired = ~alone & ~undecided
    outcome = {
        "correct": paired & (given == source),
        "false": paired & (given != source),
        "missed": alone & heard,
        "ambiguous": undecided,
        "null": alone & ~heard,
    }
    total = max(np.count_nonzero(real), 1)
    return {name: float(np.count_nonzero(real & hit) / total) for name, hit in outcome.items()}


def _north_east(length, angle_deg):
    angle = np.radians(angle_deg)
    return np.asarray(length)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)


def _observe(rng, scenario, bearing):
    noisy = bearing + scenario.error * rng.standard_normal(bearing.shape)
    detected = rng.random(bearing.shape) < scenario.detection_probability
    source = np.where(detected, np.arange(bearing.shape[-1]), NOTHING)
    count = rng.poisson(scenario.false_alarms, bearing.shape[:-1])
    extra = np.arange(count.max(initial=0)) < count[..., None]
    false = rng.uniform(*np.radians(scenario.false_alarm_sector_deg), extra.shape)
    heard = np.concatenate([np.where(detected, noisy, np.nan), np.where(extra, false, np.nan)], axis=-1)
    return heard, np.concatenate([source, np.where(extra, FALSE_ALARM, NOTHING)], axis=-1)


def _slope(theta, target_range, baseline):
    ratio = baseline / target_range
    return (1 - ratio * np.cos(theta)) / (1 + ratio**2 - 2 * ratio * np.cos(theta))


def _angle_abc(angle, target_range, baseline):
    side = np.sqrt(target_range**2 + baseline**2 - 2 * target_range * baseline * np.cos(angle))
    return np.arccos(np.clip((side**2 + baseline**2 - target_range**2) / (2 * baseline * side), -1, 1))


def _first_true(mask):
    if mask.shape[-1] == 0:
        return np.full(mask.shape[:-1], NO_PARTNER)
    return np.where(np.any(mask, axis=-1), np.argmax(mask, axis=-1), NO_PARTNER)


def _require_range(name, value):
    value = np.asarray(value, dtype=float)
    if np.any(value <= 0):
        raise ValueError(f"{name} must be above 0 m, but {np.min(value):g} was given")
    return value


def _require_gate(left, right, first_error, second_error, baseline, low, up):
    require_positive("baseline", baseline)
    require_between("first_error", first_error, 0, np.pi / 2)
    require_between("second_error", second_error, 0, np.pi / 2)
    low, up = _require_range("low", low), _require_range("up", up)
    if np.any(low >= up):
        raise ValueError(f"low must be below up, but low {np.max(low):g} and up {np.min(up):g} m were given")
    holds_zero = np.floor(right / (2 * np.pi)) > np.floor(left / (2 * np.pi))
    nearest = baseline * np.where(holds_zero, 1.0, np.maximum(np.cos(left), np.cos(right)))
    if np.any(low <= nearest):
        limit = np.max(np.where(low <= nearest, nearest, -np.inf))
        raise ValueError(
            f"low must be above {limit:g} m, where array 2 is abeam of the line of sight, "
            f"but {np.min(low):g} was given"
        )
