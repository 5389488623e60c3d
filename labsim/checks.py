"""What a notebook says about answers and claims: feedback on an exercise, the table of a paper's claims."""

from dataclasses import asdict, dataclass
from html import escape
from importlib.util import find_spec

import numpy as np

from labsim.arguments import require_choice

HOLDS = "holds"
CONDITIONAL = "holds with conditions"
FAILS = "does not hold"
VERDICTS = (HOLDS, CONDITIONAL, FAILS)


@dataclass(frozen=True)
class Feedback:
    """What the lab says of an answer: `status` is "not answered yet", "right" or "look again"."""

    status: str
    hint: str = ""

    @property
    def right(self):
        """True for a right answer."""
        return self.status == "right"

    def __repr__(self):
        return f"{self.status}: {self.hint}" if self.hint else self.status


NOT_ANSWERED = Feedback("not answered yet", "replace the ... above by your answer and run the cell again")


def check_number(answer, expected, tolerance, hint="", mistakes=()):
    """Feedback on a numeric answer.

    answer : a number, or ... while unanswered
    expected, tolerance : right if |answer - expected| <= tolerance * |expected|
    hint : what to look at again; mistakes : pairs (wrong number, what it tells about the mistake)
    """
    if answer is ... or answer is None:
        return NOT_ANSWERED
    try:
        answer = float(np.squeeze(answer))
    except (TypeError, ValueError):
        return Feedback("look again", f"the answer must be one number, but it is {answer!r}")
    if not np.isfinite(answer):
        return Feedback("look again", "the answer must be a finite number")
    if abs(answer - expected) <= tolerance * abs(expected):
        return Feedback("right")
    for wrong, explanation in mistakes:
        if abs(answer - wrong) <= tolerance * abs(wrong):
            return Feedback("look again", explanation)
    return Feedback("look again", hint)


def check_choice(answer, expected, choices, hint=""):
    """Feedback on an answer that is one of `choices`, which are words, or ... while unanswered."""
    if answer is ... or answer is None:
        return NOT_ANSWERED
    if not isinstance(answer, str) or answer not in choices:
        return Feedback("look again", f"the answer must be one of {', '.join(map(repr, choices))}")
    return Feedback("right") if answer == expected else Feedback("look again", hint)


@dataclass(frozen=True)
class Claim:
    """One claim of a paper: the statement, the paper's value, ours with its uncertainty, and a verdict."""

    statement: str
    paper: str
    measured: str
    verdict: str

    def __post_init__(self):
        require_choice("verdict", self.verdict, VERDICTS)


class Table:
    """Rows under a head, shown as a table.

    head : the columns' titles; rows : sequences of as many values, shown as they are written
    name : of a table that reproduces one of a paper's, such as "paper3_table1", with the parameters
        that made it; `python3 -m labsim figures` writes these to files
    """

    def __init__(self, head, rows, name=None, **parameters):
        self.head, self.rows = tuple(head), [tuple(map(str, row)) for row in rows]
        self.name, self.parameters = name, parameters
        if any(len(row) != len(self.head) for row in self.rows):
            raise ValueError(f"rows must have {len(self.head)} values, one for each title in head")

    def __repr__(self):
        return "\n".join(" | ".join(row) for row in (self.head, *self.rows))

    def _repr_html_(self):
        def line(tag, row):
            return (
                "<tr>" + "".join(f'<{tag} style="text-align:left">{text}</{tag}>' for text in row) + "</tr>"
            )

        body = "".join(line("td", self._marked(row)) for row in self.rows)
        return f"<table><thead>{line('th', map(escape, self.head))}</thead><tbody>{body}</tbody></table>"

    def _marked(self, row):
        return [escape(text) for text in row]


class ClaimsTable(Table):
    """The claims of a paper with their verdicts; saved with the notebook as data, too."""

    MIME = "application/vnd.labsim.claims+json"

    def __init__(self, *claims):
        self.claims = claims
        rows = [(claim.statement, claim.paper, claim.measured, claim.verdict) for claim in claims]
        super().__init__(("The paper says", "its value", "we measure", "verdict"), rows)

    def _marked(self, row):
        *values, verdict = super()._marked(row)
        return [*values, f"<b>{verdict}</b>"]

    def _repr_mimebundle_(self, **_):
        return {
            "text/plain": repr(self),
            "text/html": self._repr_html_(),
            self.MIME: [asdict(claim) for claim in self.claims],
        }


def verdict(holds, everywhere=True):
    """The verdict on a claim, from two measured truths: it holds at all, and it holds without conditions."""
    if not holds:
        return FAILS
    return HOLDS if everywhere else CONDITIONAL


def check_installation():
    """Feedback on the installation: whether every package the notebooks need can be found."""
    missing = [
        name
        for name in ("numpy", "scipy", "matplotlib", "ipywidgets", "jupyterlab")
        if find_spec(name) is None
    ]
    if missing:
        hint = f"missing: {', '.join(missing)}; close the lab and start it again with: python3 -m labsim"
        return Feedback("look again", hint)
    return Feedback("right", "the lab is complete")
