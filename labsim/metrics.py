"""How far an estimate is from the truth: errors of numbers, of angles, and when an error has settled."""

import numpy as np

from labsim.arguments import require_positive


def angle_difference(angle, reference):
    """angle - reference in [-pi, pi), radians; the one function by which angles differ. NaN stays NaN."""
    return (np.asarray(angle, dtype=float) - reference + np.pi) % (2 * np.pi) - np.pi


def rmse(error, axis=0):
    """Root mean square of errors along `axis` (the trials)."""
    return np.sqrt(np.mean(np.square(error), axis=axis))


def angle_rmse(angle, truth, axis=0):
    """Root mean square of the wrapped angle error along `axis`, radians."""
    return rmse(angle_difference(angle, truth), axis)


def circular_mean(angle, axis=0):
    """Direction of the mean unit vector, radians."""
    return np.angle(np.mean(np.exp(1j * np.asarray(angle)), axis=axis))


def rmse_standard_error(value, trials):
    """Standard error of an RMSE measured over independent Gaussian errors: value / sqrt(2 trials)."""
    return np.asarray(value) / np.sqrt(2 * require_positive("trials", trials))


def convergence_time(time, error, threshold):
    """First time from which |error| stays within `threshold` to the end.

    time : (n,); error : (..., n); threshold : in the unit of `error`, above 0
    Returns (...), NaN where the last error is still outside (or NaN).
    """
    require_positive("threshold", threshold)
    settled = np.abs(error) <= threshold
    stays = np.flip(np.logical_and.accumulate(np.flip(settled, -1), -1), -1)
    first = np.argmax(stays, axis=-1)
    return np.where(stays[..., -1], np.asarray(time, dtype=float)[first], np.nan)
