"""Feedback on the exercises of notebook 10: right answers pass, typical mistakes get their own hint."""

import numpy as np
import pytest

from labsim.exercises import your_own_data as exercises
from labsim.motion import waypoint_track

CORNER = waypoint_track([0, 10, 20, 30, 40], [(0, 0), (100, 0), (200, 0), (200, 100), (200, 200)])


def test_unanswered_exercises_wait():
    for feedback in (
        exercises.path_length(..., CORNER),
        exercises.best_depth(...),
        exercises.gains_for_outward_velocity(...),
    ):
        assert feedback.status == "not answered yet"


def test_path_length_follows_the_track_and_not_the_bird():
    points = CORNER.position(np.linspace(0, 40, 4001))
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    assert exercises.path_length(length, CORNER).right
    assert "bird" in exercises.path_length(np.hypot(200, 200), CORNER).hint


def test_best_depth_minimises_the_error():
    depth = np.linspace(50, 400, 3501)
    best = depth[np.argmin((200.0**2 + depth**2) ** 1.5 / depth)]
    assert exercises.best_depth(best).right
    assert "other way round" in exercises.best_depth(200 * np.sqrt(2)).hint
    assert not exercises.best_depth(200).right


@pytest.mark.parametrize("gains", [(1, -1, -1, -1), (-1, 1, 1, 1), [2, -2, -2, -2]])
def test_gains_that_turn_the_intensity_are_right(gains):
    assert exercises.gains_for_outward_velocity(gains).right


@pytest.mark.parametrize(
    "gains, hint",
    [
        ((-1, -1, -1, -1), "not at all"),
        ((1, 1, 1, 1), "not at all"),
        ((1, -1, 1, 1), "all three"),
        ((1, -2, -1, -1), "not a size"),
        ((1, -1, -1), "four numbers"),
        ("minus", "four numbers"),
        ((1, np.nan, -1, -1), "four numbers"),
    ],
)
def test_wrong_gains_are_told_apart(gains, hint):
    feedback = exercises.gains_for_outward_velocity(gains)
    assert not feedback.right and hint in feedback.hint
