"""OSPA and GOSPA against their definitions by brute force, and the properties of a distance."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from labsim.metrics import gospa, ospa

points = st.integers(0, 4).flatmap(lambda n: arrays(float, (n, 2), elements=st.floats(-500, 500)))


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


@given(points, points, st.floats(10, 1_000), st.sampled_from([1, 2]))
def test_ospa_is_its_definition(one, other, cutoff, order):
    small, large = sorted((one, other), key=len)
    total, location, cardinality = ospa(one, other, cutoff, order)
    expected = 0.0
    if len(large):
        spare = cutoff**order * (len(large) - len(small))
        expected = ((best_total(small, large, cutoff, order) + spare) / len(large)) ** (1 / order)
    assert total == pytest.approx(expected, abs=1e-6)
    assert total**order == pytest.approx(location**order + cardinality**order, rel=1e-9, abs=1e-9)


@given(points, points, st.floats(10, 1_000), st.sampled_from([1, 2]))
def test_gospa_is_its_definition_with_alpha_2(one, other, cutoff, order):
    small, large = sorted((one, other), key=len)
    spare = cutoff**order / 2 * (len(large) - len(small))
    expected = (best_total(small, large, cutoff, order) + spare) ** (1 / order)
    total, location, missed, false = gospa(one, other, cutoff, order)
    assert total == pytest.approx(expected, abs=1e-6)
    assert total**order == pytest.approx(location**order + missed**order + false**order, rel=1e-9, abs=1e-9)


@given(points, points, points)
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
