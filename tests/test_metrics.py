"""Errors of angles wrap, an error that leaves its bounds has not converged, sets have a distance."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsim.metrics import (
    angle_difference,
    angle_rmse,
    convergence_time,
    gospa,
    ospa,
    rmse,
    rmse_standard_error,
)

ANGLES = st.floats(-50.0, 50.0)
POINTS = st.integers(0, 4).flatmap(lambda n: arrays(float, (n, 2), elements=st.floats(-500, 500)))


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
    with pytest.raises(ValueError, match="error must have shape .* 5.*, but"):
        convergence_time(time, error[:, :3], 1.0)


def test_an_error_far_below_zero_has_not_converged():
    error = np.array([[-5.0, -5.0, -0.5, 0.5], [0.0, 0.0, 0.0, -5.0]])
    np.testing.assert_array_equal(convergence_time(np.arange(4.0), error, 1.0), [2.0, np.nan])


@given(st.lists(st.floats(-3, 3), min_size=2, max_size=20))
def test_turning_the_sign_of_every_error_changes_nothing(error):
    time = np.arange(len(error), dtype=float)
    mirrored = convergence_time(time, -np.array(error), 1.0)
    np.testing.assert_array_equal(convergence_time(time, np.array(error), 1.0), mirrored)


# Sets of points, against the definitions by brute force


def best_total(small, large, cutoff, order):
    """Least sum of cut-off distances to the power of the order, over all pairings of `small` with `large`."""
    return min(
        (
            sum(
                min(np.linalg.norm(a - large[i]), cutoff) ** order for a, i in zip(small, chosen, strict=True)
            )
            for chosen in permutations(range(len(large)), len(small))
        ),
        default=0.0,
    )


@given(POINTS, POINTS, st.floats(10, 1_000), st.sampled_from([1, 2]))
def test_ospa_is_its_definition(one, other, cutoff, order):
    small, large = sorted((one, other), key=len)
    total, location, cardinality = ospa(one, other, cutoff, order)
    expected = 0.0
    if len(large):
        spare = cutoff**order * (len(large) - len(small))
        expected = ((best_total(small, large, cutoff, order) + spare) / len(large)) ** (1 / order)
    assert total == pytest.approx(expected, abs=1e-6)
    assert total**order == pytest.approx(location**order + cardinality**order, rel=1e-9, abs=1e-9)


@given(POINTS, POINTS, st.floats(10, 1_000), st.sampled_from([1, 2]))
def test_gospa_is_its_definition_with_alpha_2(one, other, cutoff, order):
    small, large = sorted((one, other), key=len)
    spare = cutoff**order / 2 * (len(large) - len(small))
    expected = (best_total(small, large, cutoff, order) + spare) ** (1 / order)
    total, location, missed, false = gospa(one, other, cutoff, order)
    assert total == pytest.approx(expected, abs=1e-6)
    assert total**order == pytest.approx(location**order + missed**order + false**order, rel=1e-9, abs=1e-9)


@given(POINTS, POINTS, POINTS)
def test_both_are_distances(one, other, third):
    for distance in (ospa, gospa):
        between = distance(one, other, 300.0)[0]
        assert distance(one, one, 300.0)[0] == 0
        assert distance(other, one, 300.0)[0] == pytest.approx(between, abs=1e-9)
        assert between <= distance(one, third, 300.0)[0] + distance(third, other, 300.0)[0] + 1e-6


def test_the_parts_say_what_is_wrong():
    truth = np.array([[0.0, 0.0], [1_000.0, 0.0]])
    assert ospa(truth + [30.0, 0.0], truth, 500.0) == pytest.approx((30.0, 30.0, 0.0))
    assert ospa(truth[:1], truth, 500.0) == pytest.approx((500 / np.sqrt(2), 0.0, 500 / np.sqrt(2)))
    assert ospa(np.empty((0, 2)), truth, 500.0) == pytest.approx((500.0, 0.0, 500.0))
    half = 500 / np.sqrt(2)
    assert gospa(truth[:1], truth, 500.0) == pytest.approx((half, 0.0, half, 0.0))
    assert gospa(truth, truth[:1], 500.0) == pytest.approx((half, 0.0, 0.0, half))
    assert gospa([[0.0, 900.0]], truth[:1], 500.0) == pytest.approx((500.0, 0.0, half, half))


def test_two_empty_sets_agree():
    nobody = np.empty((0, 2))
    assert ospa(nobody, nobody, 500.0) == (0.0, 0.0, 0.0)
    assert gospa(nobody, nobody, 500.0) == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("distance", [ospa, gospa])
def test_bad_sets_are_refused_in_words(distance):
    with pytest.raises(ValueError, match="cutoff must be above 0"):
        distance([[0.0, 0.0]], [[0.0, 0.0]], 0.0)
    with pytest.raises(ValueError, match="order must lie between 1"):
        distance([[0.0, 0.0]], [[0.0, 0.0]], 1.0, 0.5)
    with pytest.raises(ValueError, match="estimates must be finite"):
        distance([[np.nan, 0.0]], [[0.0, 0.0]], 1.0)
    with pytest.raises(ValueError, match="truth must have shape"):
        distance([[0.0, 0.0]], [0.0, 0.0], 1.0)
