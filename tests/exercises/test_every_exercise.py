"""Whatever is typed into an exercise, it answers in words."""

import inspect
from importlib import import_module

import numpy as np
import pytest
from conftest import ROOT

from labsim.checks import Feedback

MODULES = sorted(path.stem for path in (ROOT / "labsim" / "exercises").glob("[a-z]*.py"))


def takes_an_answer_alone(function):
    needed = [p.name for p in inspect.signature(function).parameters.values() if p.default is p.empty]
    return needed == ["answer"]


EXERCISES = [
    pytest.param(function, id=f"{module}-{name}")
    for module in MODULES
    for name, function in inspect.getmembers(import_module(f"labsim.exercises.{module}"), inspect.isfunction)
    if name[0] != "_" and function.__module__.endswith(module) and takes_an_answer_alone(function)
]
NONSENSE = {
    "words": "no idea",
    "nothing": "",
    "NaN": np.nan,
    "infinity": np.inf,
    "empty list": [],
    "dict": {},
    "five numbers": (1, 2, 3, 4, 5),
    "array": np.array([1.0, np.nan]),
    "function": lambda: 0,
}


@pytest.mark.parametrize("exercise", EXERCISES)
def test_dots_are_no_answer_yet(exercise):
    assert exercise(...).status == "not answered yet"


@pytest.mark.parametrize("exercise", EXERCISES)
@pytest.mark.parametrize("answer", NONSENSE.values(), ids=NONSENSE.keys())
def test_nonsense_is_never_right_and_never_a_stack_trace(exercise, answer):
    feedback = exercise(answer)
    assert isinstance(feedback, Feedback) and not feedback.right
