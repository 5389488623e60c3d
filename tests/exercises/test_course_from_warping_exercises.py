"""Every exercise of chapter 06 waits, knows the right answer, and says something of typical mistakes."""

import numpy as np
import pytest

from labsim.exercises import course_from_warping as exercises

ALL = (
    exercises.band_constant,
    exercises.expected_delay,
    exercises.easiest_course,
    exercises.common_scale,
    exercises.averaging,
)


@pytest.mark.parametrize("exercise", ALL)
def test_exercise_waits_for_an_answer_and_survives_nonsense(exercise):
    assert exercise(...).status == "not answered yet"
    for nonsense in ("north", [1, 2, 3], float("nan")):
        assert exercise(nonsense).status == "look again"


@pytest.mark.parametrize(
    "answer, words",
    [(67_500, None), (90_000, "arithmetic mean"), (np.sqrt(67_500), "C is its square"), (1, "two limits")],
)
def test_band_constant(answer, words):
    feedback = exercises.band_constant(answer)
    assert feedback.right if words is None else words in feedback.hint


@pytest.mark.parametrize(
    "answer, words",
    [(48.9, None), (0.0489, "in seconds"), (69.8, "at 10 km"), (17.8, "pair 1-2"), (31.1, "pair 2-3")],
)
def test_expected_delay(answer, words):
    feedback = exercises.expected_delay(answer)
    assert feedback.right if words is None else words in feedback.hint


@pytest.mark.parametrize(
    "answer, words",
    [
        (150, None),
        (330, None),
        (-30, None),
        (147, None),
        (60, "along"),
        (240, "along"),
        (180, "vanish"),
        (np.inf, "vanish"),
        (144, "vanish"),
    ],
)
def test_easiest_course(answer, words):
    feedback = exercises.easiest_course(answer)
    assert feedback.right if words is None else words in feedback.hint


def test_common_scale_moves_the_papers_course_and_not_the_centred_one():
    tied, centred = exercises.common_scale_change()
    assert 3 < tied < 4.5 and centred < 1e-6
    assert exercises.common_scale((tied, 0.0)).right
    assert exercises.common_scale((-tied, 1e-9)).right
    assert "paper's estimator" in exercises.common_scale((1.0, 0.0)).hint
    assert "centred" in exercises.common_scale((tied, 2.0)).hint
    assert "pair" in exercises.common_scale(tied).hint
    for pair in ((np.nan, np.nan), (np.nan, 0.0), (tied, np.nan), (np.inf, 0.0)):
        assert exercises.common_scale(pair).status == "look again"


def test_averaging_has_a_best_length_between_noise_and_smear():
    """Medians of five runs (seeds 0 to 4) lie far on their side of 1 %: 0.5, above 5, above 5 %."""
    errors = {frames: 100 * np.median(exercises.averaging_errors(frames)) for frames in (8, 32, 200)}
    assert errors[32] < 0.8 and errors[8] > 3 and errors[200] > 3
    assert exercises.averaging(32).right
    assert "noise" in exercises.averaging(8).hint
    assert "smears" in exercises.averaging(200).hint
    assert "whole number" in exercises.averaging(0).hint
