"""Feedback of chapter 03: right answers are right, and typical mistakes are recognised."""

import numpy as np
import pytest

from labsim.exercises import position_and_velocity as exercises
from labsim.metrics import rmse
from labsim.surface_motion import motion_fit, position, slant_range, weighted_motion_fit
from labsim.vector_sensor import PassingVessel, direction_of_arrival, sample_intensity

NUMBERS = (
    exercises.scatter_at_distance,
    exercises.speed_with_wrong_depth,
    exercises.course_of_the_line,
    exercises.shortest_window,
)


@pytest.mark.parametrize("exercise", NUMBERS)
def test_dots_are_not_an_answer(exercise):
    assert exercise(...).status == "not answered yet"


@pytest.mark.parametrize("exercise", NUMBERS)
@pytest.mark.parametrize("answer", ["twelve", float("nan"), -3.0])
def test_nonsense_is_looked_at_again(exercise, answer):
    assert exercise(answer).status == "look again"


def test_scatter_grows_with_the_cube_of_range():
    assert exercises.scatter_at_distance(8).right
    assert "the angle itself" in exercises.scatter_at_distance(4).hint
    assert "other way round" in exercises.scatter_at_distance(1 / 8).hint


def test_speed_grows_with_the_believed_depth():
    assert exercises.speed_with_wrong_depth(12.6).right
    assert "farther out" in exercises.speed_with_wrong_depth(11.43).hint
    assert "multiplies" in exercises.speed_with_wrong_depth(12).hint


def test_the_course_of_the_line():
    # Independent: numpy's polyfit through the windows up to 40 s of 400 other runs. Either RMSE of 400 runs
    # is known to 3.5 %, their ratio to 5 %; the exercise allows 15 %.
    vessel = PassingVessel()
    heard = direction_of_arrival(sample_intensity(vessel, np.random.default_rng(40), 400))
    slope = [np.polyfit(*points[:80].T, 1)[0] for points in position(*heard, vessel.sensor_depth)]
    error = rmse(np.degrees(np.arctan(slope)) - 10)
    assert exercises.course_of_the_line(error).right
    assert "radians" in exercises.course_of_the_line(np.radians(error)).hint
    assert "arctan(A)" in exercises.course_of_the_line(50).hint


def test_the_shortest_window_is_the_shortest_that_is_enough():
    found = {seconds: exercises.shortest_window(seconds) for seconds in range(2, 41)}
    assert [seconds for seconds, feedback in found.items() if feedback.right] == [22]
    assert "0.204 m/s, more than 0.2" in found[21].hint
    assert "number of windows" in exercises.shortest_window(44).hint
    assert "so are fewer" in found[23].hint
    assert "whole number" in exercises.shortest_window(22.5).hint
    assert "at most 40" in exercises.shortest_window(60).hint


def test_your_fit_is_measured_against_the_bound():
    def weighted(points, time):
        track = np.nanmean(points, axis=0)
        return weighted_motion_fit(points, time, 100, slant_range(track, 100)).velocity[:, -1]

    assert exercises.your_fit(weighted).right
    assert exercises.your_fit(lambda points, time: ...).status == "not answered yet"
    assert "times the bound" in exercises.your_fit(lambda d, t: motion_fit(d, t).velocity[:, -1]).hint
    assert "shape" in exercises.your_fit(lambda points, time: points[0, 0]).hint


def test_a_velocity_known_beforehand_is_not_a_fit():
    paper = 12 * np.array([np.cos(np.pi / 18), np.sin(np.pi / 18)])
    feedback = exercises.your_fit(lambda points, time: np.tile(paper, (len(points), 1)))
    assert feedback.status == "look again" and "9 m/s" in feedback.hint
