"""Errors of angles wrap, their means are circular, and an error that leaves its bounds has not converged."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsim.metrics import (
    angle_difference,
    angle_rmse,
    circular_mean,
    convergence_time,
    rmse,
    rmse_standard_error,
)

ANGLES = st.floats(-50.0, 50.0)


@given(angle=ANGLES, reference=ANGLES)
def test_an_angle_difference_is_the_same_turn_and_the_shortest(angle, reference):
    difference = angle_difference(angle, reference)
    assert -np.pi <= difference <= np.pi
    assert np.exp(1j * difference) == pytest.approx(np.exp(1j * (angle - reference)), abs=1e-9)


def test_an_angle_difference_keeps_shapes_and_nan():
    assert angle_difference(np.zeros((2, 3)), np.zeros(3)).shape == (2, 3)
    assert np.isnan(angle_difference(np.nan, 0.0))


def test_rmse_is_taken_over_trials():
    np.testing.assert_allclose(rmse([[3.0, 0.0], [4.0, 2.0]]), [np.sqrt(12.5), np.sqrt(2)])


def test_the_error_of_an_angle_is_small_across_the_cut():
    np.testing.assert_allclose(angle_rmse([np.pi - 0.1, -np.pi + 0.1], np.pi), 0.1)


@given(turn=ANGLES)
def test_the_circular_mean_turns_with_its_angles(turn):
    angles = np.array([-0.4, 0.1, 0.3, 0.5])
    assert angle_difference(circular_mean(angles + turn), circular_mean(angles) + turn) == pytest.approx(
        0, abs=1e-9
    )


def test_the_standard_error_of_an_rmse_is_that_of_repeated_experiments():
    # 4000 experiments of 200 trials; a standard deviation from these is known to 1.1 %.
    measured = rmse(np.random.default_rng(7).normal(scale=2.0, size=(200, 4000)))
    assert measured.std() == pytest.approx(rmse_standard_error(2.0, 200), rel=0.035)
    with pytest.raises(ValueError, match="trials must be above 0"):
        rmse_standard_error(2.0, 0)


def test_convergence_is_the_first_time_after_which_the_error_stays_small():
    time = np.arange(5.0)
    error = np.array([[5, 0, 5, 1, -1], [0, 0, 0, 0, 0], [0, 0, 0, 0, 5], [0, 0, 0, 0, np.nan]])
    np.testing.assert_array_equal(convergence_time(time, error, 1.0), [3.0, 0.0, np.nan, np.nan])
    with pytest.raises(ValueError, match="threshold must be above 0"):
        convergence_time(time, error, -1.0)
