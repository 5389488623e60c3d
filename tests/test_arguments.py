import numpy as np
import pytest

from labsim.arguments import (
    require_between,
    require_choice,
    require_finite,
    require_not_negative,
    require_positive,
    require_shape,
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
