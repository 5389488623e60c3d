"""The exercises of chapter 08: right answers are right, typical mistakes get their own hint."""

import pytest

from labsim.exercises import bistatic_gmphd as exercises


@pytest.mark.parametrize(
    "check, answer",
    [
        (exercises.range_abeam, 5_333),
        (exercises.weight_after_misses, 0.0098),
        (exercises.misses_until_pruned, 5),
        (exercises.clutter_that_fills_the_gate, 233),
    ],
)
def test_right_answers_are_right_and_dots_are_unanswered(check, answer):
    assert check(answer).right
    assert check(...).status == "not answered yet"


@pytest.mark.parametrize(
    "check, answer, words",
    [
        (exercises.range_abeam, 6_000, "half the path"),
        (exercises.range_abeam, 12_000, "whole path"),
        (exercises.weight_after_misses, 0.01, "survive"),
        (exercises.weight_after_misses, 0.099, "one miss"),
        (exercises.misses_until_pruned, 4, "still above"),
        (exercises.clutter_that_fills_the_gate, 4_670, "radius is √20"),
        (exercises.clutter_that_fills_the_gate, 11.7, "square of the gate"),
        (exercises.clutter_that_fills_the_gate, 1, "divide the area"),
    ],
)
def test_mistakes_get_a_hint(check, answer, words):
    feedback = check(answer)
    assert not feedback.right and words in feedback.hint
