"""Feedback of chapter 05: right answers are right, and typical mistakes are recognised."""

import numpy as np
import pytest

from labsim.exercises import delay_tracking_loop as exercises

NUMBERS = (
    exercises.longest_fade,
    exercises.printed_over_mended,
    exercises.best_time_constant,
    exercises.bearing_of_the_wrong_stripe,
)


@pytest.mark.parametrize("exercise", NUMBERS)
def test_dots_are_not_an_answer(exercise):
    assert exercise(...).status == "not answered yet"


@pytest.mark.parametrize("exercise", NUMBERS)
@pytest.mark.parametrize("answer", ["twelve", float("nan"), -3.0])
def test_nonsense_is_looked_at_again(exercise, answer):
    assert exercise(answer).status == "look again"


def test_longest_fade():
    assert exercises.longest_fade(25 / 6).right
    assert "cliff" in exercises.longest_fade(25 / 3).hint


def test_printed_over_mended():
    assert exercises.printed_over_mended(2.21 / 0.21).right
    assert "other way" in exercises.printed_over_mended(0.21 / 2.21).hint
    assert "variance" in exercises.printed_over_mended(np.sqrt(2.21 / 0.21)).hint


def test_best_time_constant():
    unit = 1 / (16 * np.pi**2 * 1500**2 * 500)
    assert exercises.best_time_constant((9 * 15 * unit / (4 * 30e-6**2)) ** (1 / 3)).right
    assert "printed" in exercises.best_time_constant((9 * 17 * unit / (4 * 30e-6**2)) ** (1 / 3)).hint


def test_bearing_of_the_wrong_stripe():
    assert exercises.bearing_of_the_wrong_stripe(1.15).right
    assert "radians" in exercises.bearing_of_the_wrong_stripe(0.02).hint
