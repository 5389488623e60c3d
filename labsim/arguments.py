"""Checks of arguments, in one voice: every refusal names the argument, its value and what is allowed."""

import numpy as np


def require_finite(name, value):
    """Return `value` as a float array; raise ValueError if any element is NaN or infinite."""
    array = _as_float(name, value)
    if not np.all(np.isfinite(array)):
        raise ValueError(f"{name} must be finite, but {_shown(array[~np.isfinite(array)])} was given")
    return array


def require_positive(name, value):
    """Return `value` as a float array; raise ValueError unless every element is finite and above zero."""
    array = require_finite(name, value)
    if not np.all(array > 0):
        raise ValueError(f"{name} must be above 0, but {_shown(array[array <= 0])} was given")
    return array


def require_not_negative(name, value):
    """Return `value` as a float array; raise ValueError unless every element is finite and 0 or more."""
    array = require_finite(name, value)
    if not np.all(array >= 0):
        raise ValueError(f"{name} must not be negative, but {_shown(array[array < 0])} was given")
    return array


def require_between(name, value, low, high):
    """Return `value` as a float array; raise ValueError unless low <= every element <= high."""
    array = require_finite(name, value)
    outside = (array < low) | (array > high)
    if np.any(outside):
        raise ValueError(
            f"{name} must lie between {low:g} and {high:g}, but {_shown(array[outside])} was given"
        )
    return array


def require_scalar(name, value):
    """Return `value` as a float; raise ValueError unless it is one finite number."""
    array = require_finite(name, value)
    if array.ndim:
        raise ValueError(f"{name} must be one number, but an array of shape {array.shape} was given")
    return float(array)


def require_whole(name, value, low=0, high=np.inf):
    """Return `value` as an int; raise ValueError unless it is one whole number, low <= value <= high."""
    number = require_scalar(name, value)
    if number != np.floor(number) or not low <= number <= high:
        ends = f"from {low:g} up" if high == np.inf else f"from {low:g} to {high:g}"
        raise ValueError(f"{name} must be a whole number {ends}, but {number:g} was given")
    return int(number)


def require_interval(name, value, low=-np.inf, high=np.inf):
    """Return `value` as two floats; raise ValueError unless they are (a, b) with low <= a < b <= high."""
    start, end = map(float, require_shape(name, require_finite(name, value), (2,)))
    if not low <= start < end <= high:
        within = "" if (low, high) == (-np.inf, np.inf) else f" within {low:g} to {high:g}"
        raise ValueError(
            f"{name} must be (low, high) with low below high{within}, but ({start:g}, {end:g}) was given"
        )
    return start, end


def require_shape(name, value, shape):
    """Return `value` as a float array whose last axes are `shape`; None stands for any length.

    Leading axes are free: `require_shape("velocity", v, (None, 3))` takes (n, 3) and (trials, n, 3).
    """
    array = _as_float(name, value)
    tail = array.shape[max(array.ndim - len(shape), 0) :]
    fits = len(tail) == len(shape) and all(
        want in (None, have) for want, have in zip(shape, tail, strict=True)
    )
    if not fits:
        wanted = ", ".join("n" if length is None else str(length) for length in shape)
        raise ValueError(f"{name} must have shape (..., {wanted}), but {array.shape} was given")
    return array


def require_choice(name, value, choices):
    """Return `value`; raise ValueError unless it is one of `choices`."""
    if value not in choices:
        raise ValueError(f"{name} must be one of {', '.join(map(repr, choices))}, but {value!r} was given")
    return value


def _as_float(name, value):
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a number or an array of numbers, but {value!r} was given") from None


def _shown(array):
    return f"{np.ravel(array)[0]:g}"
