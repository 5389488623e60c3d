import numpy as np
import pytest

from labsim.arguments import require_not_negative


def test_numbers_from_zero_up_are_returned_as_floats():
    np.testing.assert_array_equal(require_not_negative("power", [0, 1]), [0.0, 1.0])


@pytest.mark.parametrize("value", [-1, [1.0, -2.0], np.nan, np.inf, "loud"])
def test_negative_numbers_are_refused_by_name(value):
    with pytest.raises(ValueError, match="power"):
        require_not_negative("power", value)
