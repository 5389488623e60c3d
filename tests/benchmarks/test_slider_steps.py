"""The kernel's side of a slider step, for every Lab of every chapter: compute, draw, encode.

A reader feels a delay beyond about a tenth of a second, of which the browser needs half: the aim is
a median of 40 ms. The table is for people to read; no test fails on a time.
"""

import itertools
from functools import cache

import pytest
from conftest import CHAPTERS, count_labs

from labsim.figures import displayed
from labsim.lab import Lab

STEPS = 12


@cache
def labs_of(path):
    """Run a chapter's code and return the Labs it shows, in order."""
    return [shown for shown in displayed(path) if isinstance(shown, Lab)]


def other_values(control):
    """Values of a control other than the one it has, over its whole range."""
    if hasattr(control, "options"):
        return [value for value in control._options_values if value != control.value] + [control.value]
    if isinstance(control.value, bool):
        return [not control.value, control.value]
    if isinstance(control.value, tuple):
        span = control.max - control.min
        return [(control.min + span * k / 10, control.max - span * k / 10) for k in (1, 2, 3, 4)]
    low, high = (10**control.min, 10**control.max) if hasattr(control, "base") else (control.min, control.max)
    return [type(control.value)(low + (high - low) * k / 8) for k in range(1, 8)]


def steps_of(lab):
    """An endless walk through every control of a Lab."""
    moves = [(control, value) for control in lab.controls.values() for value in other_values(control)]
    return itertools.cycle(moves)


CASES = [
    pytest.param(path, k, id=f"{path.stem}-{k + 1}") for path in CHAPTERS for k in range(count_labs(path))
]


@pytest.mark.parametrize(("path", "index"), CASES)
def test_slider_step(path, index, benchmark):
    lab = labs_of(path)[index]
    benchmark.group = "slider steps"
    moves = steps_of(lab)

    def move():
        control, value = next(moves)
        control.value = value

    benchmark.pedantic(move, rounds=STEPS)
    assert "A fault of the lab" not in lab._status.value
