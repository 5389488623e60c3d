"""The exercises of chapter 07: right answers are right, typical mistakes get their own hint."""

import pytest

from labsim.exercises import bearing_gate_association as exercises


@pytest.mark.parametrize(
    "check, answer",
    [
        (exercises.moving_edge, "counter-clockwise"),
        (exercises.three_sigma_gate, 42.35),
        (exercises.time_to_failure, 153.2),
        (exercises.rule_in_clutter, "nearest gate centre"),
    ],
)
def test_right_answers_are_right_and_dots_are_unanswered(check, answer):
    assert check(answer).right
    assert check(...).status == "not answered yet"


@pytest.mark.parametrize(
    "check, answer, words",
    [
        (exercises.moving_edge, "both", "which orange line"),
        (exercises.moving_edge, "up", "must be one of"),
        (exercises.three_sigma_gate, 18.1, "one-sigma gate"),
        (exercises.three_sigma_gate, 36, "parallax is missing"),
        (exercises.time_to_failure, 2_404, "that is the range"),
        (exercises.time_to_failure, 80.1, "count from the minimum range"),
        (exercises.rule_in_clutter, "assignment", "simulate it"),
    ],
)
def test_mistakes_get_a_hint(check, answer, words):
    feedback = check(answer)
    assert not feedback.right and words in feedback.hint


def test_the_best_rule_in_clutter_is_best_by_a_margin():
    # about 5 400 sources heard: standard error of a share 0.007
    best, second = sorted(exercises.rates_in_clutter().values(), reverse=True)[:2]
    assert best - second > 0.05
