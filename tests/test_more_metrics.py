"""Convergence looks at the size of an error, whatever its sign."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from labsim.metrics import convergence_time


def test_an_error_far_below_zero_has_not_converged():
    error = np.array([[-5.0, -5.0, -0.5, 0.5], [0.0, 0.0, 0.0, -5.0]])
    np.testing.assert_array_equal(convergence_time(np.arange(4.0), error, 1.0), [2.0, np.nan])


@given(st.lists(st.floats(-3, 3), min_size=2, max_size=20))
def test_turning_the_sign_of_every_error_changes_nothing(error):
    time = np.arange(len(error), dtype=float)
    mirrored = convergence_time(time, -np.array(error), 1.0)
    np.testing.assert_array_equal(convergence_time(time, np.array(error), 1.0), mirrored)
