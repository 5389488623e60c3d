import numpy as np
import pytest

from labsim.arguments import (
    require_between,
    require_choice,
    require_finite,
    require_interval,
    require_not_negative,
    require_positive,
    require_scalar,
    require_shape,
    require_whole,
)


def test_numbers_from_zero_up_are_returned_as_floats():
    np.testing.assert_array_equal(require_not_negative("power", [0, 1]), [0.0, 1.0])


@pytest.mark.parametrize("value", [-1, [1.0, -2.0], np.nan, np.inf, "loud"])
def test_negative_numbers_are_refused_by_name(value):
    with pytest.raises(ValueError, match="power"):
        require_not_negative("power", value)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: require_finite("depth", [1.0, np.nan]), "depth must be finite, but nan was given"),
        (
            lambda: require_finite("depth", "deep"),
            "depth must be a number or an array of numbers, but 'deep'",
        ),
        (lambda: require_positive("depth", [3.0, 0.0]), "depth must be above 0, but 0 was given"),
        (
            lambda: require_between("angle", 4.0, 0.0, 3.5),
            "angle must lie between 0 and 3.5, but 4 was given",
        ),
        (
            lambda: require_shape("v", np.zeros((4, 2)), (None, 3)),
            r"v must have shape \(..., n, 3\), but \(4, 2\)",
        ),
        (lambda: require_shape("v", 1.0, (3,)), "v must have shape"),
        (lambda: require_scalar("depth", [1.0]), r"depth must be one number, but an array of shape \(1,\)"),
        (
            lambda: require_whole("trials", 2.5, 1),
            "trials must be a whole number from 1 up, but 2.5 was given",
        ),
        (lambda: require_whole("span", 1, 2, 8), "span must be a whole number from 2 to 8, but 1 was given"),
        (lambda: require_whole("span", 9, 2, 8), "span must be a whole number from 2 to 8, but 9 was given"),
        (
            lambda: require_interval("band", (3.0, 3.0)),
            r"band must be \(low, high\) with low below high, but \(3, 3\) was given",
        ),
        (
            lambda: require_interval("band", (1.0, 9.0), 0, 8),
            r"band must be \(low, high\) with low below high within 0 to 8, but \(1, 9\) was given",
        ),
        (lambda: require_interval("band", 3.0), r"band must have shape \(..., 2\)"),
        (
            lambda: require_choice("fit", "cubic", ("raw", "line")),
            "fit must be one of 'raw', 'line', but 'cubic'",
        ),
    ],
)
def test_every_refusal_names_the_argument_its_value_and_what_is_allowed(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_good_arguments_come_back_as_float_arrays_of_any_batch():
    assert require_positive("depth", 3).dtype == float
    assert require_shape("v", np.zeros((5, 7, 3)), (None, 3)).shape == (5, 7, 3)
    np.testing.assert_array_equal(require_between("angle", [0, 1], 0, 1), [0.0, 1.0])
    assert require_choice("fit", "raw", ("raw", "line")) == "raw"
    assert require_interval("band", [0, 8], 0, 8) == (0.0, 8.0)
    assert require_scalar("depth", np.int64(3)) == 3.0
    whole = require_whole("trials", 3.0, 3, 3)
    assert whole == 3 and isinstance(whole, int)
