"""How far an estimate is from the truth: errors of numbers, of angles, and when an error has settled."""

import numpy as np
from scipy.optimize import linear_sum_assignment

from labsim.arguments import require_between, require_finite, require_positive, require_shape


def angle_difference(angle, reference):
    """angle - reference from -pi to pi, radians; the one function by which angles differ. NaN stays NaN."""
    return (np.asarray(angle, dtype=float) - reference + np.pi) % (2 * np.pi) - np.pi


def rmse(error, axis=0):
    """Root mean square of errors along `axis` (the trials)."""
    return np.sqrt(np.mean(np.square(error), axis=axis))


def angle_rmse(angle, truth, axis=0):
    """Root mean square of the wrapped angle error along `axis`, radians."""
    return rmse(angle_difference(angle, truth), axis)


def rmse_standard_error(value, trials):
    """Standard error of an RMSE measured over independent Gaussian errors: value / sqrt(2 trials)."""
    return np.asarray(value) / np.sqrt(2 * require_positive("trials", trials))


def convergence_time(time, error, threshold):
    """First time from which |error| stays within `threshold` to the end.

    time : (n,); error : (..., n); threshold : in the unit of `error`, above 0
    Returns (...), NaN where the last error is still outside (or NaN).
    Raises ValueError for shapes that do not match or a threshold that is not positive.
    """
    require_positive("threshold", threshold)
    time = require_shape("time", time, (None,))
    error = require_shape("error", error, time.shape)
    settled = np.abs(error) <= threshold
    stays = np.flip(np.logical_and.accumulate(np.flip(settled, -1), -1), -1)
    first = np.argmax(stays, axis=-1)
    return np.where(stays[..., -1], time[first], np.nan)


def ospa(estimates, truth, cutoff, order=2):
    """Optimal subpattern assignment distance between two sets of points, with its two parts.

    estimates : (m, d); truth : (n, d), any m and n, 0 included; cutoff : the most one point may cost, above 0
    order : p >= 1. Returns (distance, location, cardinality), in the unit of the points:
    distance^p = location^p + cardinality^p, each a mean over max(m, n). Two empty sets are at distance 0.
    (Schuhmacher, Vo & Vo 2008, eq. 3.)
    """
    paired, unpaired, larger = _pair_cost(estimates, truth, cutoff, order)
    if larger == 0:
        return 0.0, 0.0, 0.0
    location = np.sum(np.minimum(paired, cutoff) ** order) / larger
    cardinality = cutoff**order * unpaired / larger
    return tuple(float(part ** (1 / order)) for part in (location + cardinality, location, cardinality))


def gospa(estimates, truth, cutoff, order=2):
    """Generalised OSPA (alpha = 2) between two sets of points, with its parts.

    Arguments as for `ospa`. Returns (distance, location, missed, false): distance^p = location^p + missed^p +
    false^p, sums and not means; each point left alone costs cutoff^p / 2, and pairs beyond the cutoff are
    two points left alone. (Rahmathullah, Garcia-Fernandez & Svensson 2017, proposition 1.)
    """
    paired, _, _ = _pair_cost(estimates, truth, cutoff, order)
    kept = paired[paired < cutoff]
    location = np.sum(kept**order)
    missed, false = (cutoff**order / 2 * (len(points) - kept.size) for points in (truth, estimates))
    return tuple(float(part ** (1 / order)) for part in (location + missed + false, location, missed, false))


def _pair_cost(estimates, truth, cutoff, order):
    require_positive("cutoff", cutoff)
    require_between("order", order, 1, np.inf)
    estimates, truth = (np.asarray(points, dtype=float) for points in (estimates, truth))
    for name, points in (("estimates", estimates), ("truth", truth)):
        require_shape(name, require_finite(name, points), (None, None))
    larger = max(len(estimates), len(truth))
    if min(len(estimates), len(truth)) == 0:
        return np.zeros(0), larger, larger
    distance = np.linalg.norm(estimates[:, None] - truth[None], axis=-1)
    row, column = linear_sum_assignment(np.minimum(distance, cutoff) ** order)
    return distance[row, column], larger - row.size, larger
