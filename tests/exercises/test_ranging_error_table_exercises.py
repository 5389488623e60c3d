"""Feedback of chapter 04: right answers are right, and typical mistakes are recognised."""

import numpy as np
import pytest

from labsim.exercises import ranging_error_table as exercises

NUMBERS = (
    exercises.tolerance_at_8_km,
    exercises.pitch_that_costs_one_percent,
    exercises.range_from_two_delays,
)


@pytest.mark.parametrize("exercise", (*NUMBERS, exercises.what_to_average))
def test_dots_are_not_an_answer(exercise):
    assert exercise(...).status == "not answered yet"


@pytest.mark.parametrize("exercise", NUMBERS)
@pytest.mark.parametrize("answer", ["twelve", float("nan"), -3.0])
def test_nonsense_is_looked_at_again(exercise, answer):
    assert exercise(answer).status == "look again"


def test_tolerance_at_8_km():
    assert exercises.tolerance_at_8_km(7.8).right
    assert "millimetres" in exercises.tolerance_at_8_km(0.0078).hint
    assert "millimetres" in exercises.tolerance_at_8_km(0.78).hint
    assert "twice" in exercises.tolerance_at_8_km(15.6).hint


def test_pitch_that_costs_one_percent():
    assert exercises.pitch_that_costs_one_percent(5.74).right
    assert "radians" in exercises.pitch_that_costs_one_percent(0.1002).hint


def test_range_from_two_delays():
    cosine_squared = 1 - (1500 * 9.18765e-3 / 50) ** 2
    right = 2500 * cosine_squared / (1500 * 0.2407e-3)
    assert exercises.range_from_two_delays(right).right
    assert "cos²" in exercises.range_from_two_delays(right / cosine_squared).hint
    assert "squared" in exercises.range_from_two_delays(right / np.sqrt(cosine_squared)).hint
    assert "kilometres" in exercises.range_from_two_delays(right / 1000).hint


def test_what_to_average():
    assert (
        exercises.what_to_average("curvature").right and exercises.what_to_average("delay difference").right
    )
    assert exercises.what_to_average("range").status == "look again"
    assert "one of" in exercises.what_to_average("speed").hint
