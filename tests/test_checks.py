"""What the lab says of an answer and of a claim."""

import pytest

from labsim import checks
from labsim.checks import Claim, ClaimsTable, check_choice, check_number, verdict


def speed_answer(answer):
    return check_number(
        answer, 12.0, 0.02, hint="divide by T", mistakes=[(24.0, "that is the step, not the speed")]
    )


@pytest.mark.parametrize("blank", [..., None])
def test_a_blank_is_not_an_answer(blank):
    assert speed_answer(blank).status == check_choice(blank, "line", ["line"]).status == "not answered yet"
    assert not speed_answer(blank).right


def test_a_number_is_right_within_its_tolerance():
    assert speed_answer(12.2).right
    assert speed_answer("11.8").right
    assert repr(speed_answer(12)) == "right"


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (13.0, "divide by T"),
        (24.1, "that is the step"),
        (float("nan"), "finite"),
        ("fast", "one number"),
        ([1, 2], "one number"),
    ],
)
def test_a_wrong_number_gets_a_hint(answer, words):
    feedback = speed_answer(answer)
    assert feedback.status == "look again" and not feedback.right
    assert words in feedback.hint and repr(feedback).startswith("look again: ")


def test_a_choice_is_right_wrong_or_not_among_the_choices():
    choices = ("raw", "line")
    assert check_choice("line", "line", choices).right
    assert check_choice("raw", "line", choices, hint="it is cleaner").hint == "it is cleaner"
    assert "must be one of 'raw', 'line'" in check_choice("motion", "line", choices).hint


def test_a_verdict_follows_from_two_measured_truths():
    assert [verdict(False), verdict(True), verdict(True, everywhere=False)] == [
        "does not hold",
        "holds",
        "holds with conditions",
    ]


def test_a_claims_table_reads_as_text_and_as_a_table():
    table = ClaimsTable(Claim("error < 0.2 m/s", "0.2", "4.3 +- 0.1", verdict(False)))
    assert repr(table).splitlines()[1] == "error < 0.2 m/s | 0.2 | 4.3 +- 0.1 | does not hold"
    assert "error &lt; 0.2 m/s" in table._repr_html_()
    assert "<b>does not hold</b>" in table._repr_html_()


def test_a_claim_needs_a_verdict_of_the_house():
    with pytest.raises(ValueError, match="verdict must be one of 'holds'"):
        Claim("all is well", "yes", "yes", "certainly")


def test_a_table_escapes_what_html_would_read():
    shown = checks.Table(("a < b",), [("1 & 2",)])._repr_html_()
    assert "a &lt; b" in shown and "1 &amp; 2" in shown


def test_a_table_with_a_row_too_short_is_refused():
    with pytest.raises(ValueError, match="rows must have 2 values"):
        checks.Table(("a", "b"), [(1, 2), (3,)])


def test_a_complete_installation_is_right_and_a_missing_package_is_named(monkeypatch):
    assert checks.check_installation().right
    monkeypatch.setattr(checks, "find_spec", lambda name: None if name == "scipy" else object())
    found = checks.check_installation()
    assert not found.right and "missing: scipy;" in found.hint and "python3 -m labsim" in found.hint
