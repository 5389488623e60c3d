"""Feedback on the exercises of chapter 01: right answers, typical mistakes, and none."""

import numpy as np
import pytest

from labsim.exercises import signal_model as exercises
from labsim.vector_sensor import PassingVessel, closest_approach, geometry


@pytest.mark.parametrize(
    ("exercise", "right", "wrong"),
    [
        (exercises.times_farther, 3.0, 9.0),
        (exercises.times_farther, 3.0, 1 / 3),
        (exercises.peak_at_twice_the_range, -6.0, -3.0),
        (exercises.peak_at_twice_the_range, -6.02, 6.0),
        (exercises.width_at_twice_range_and_speed, 1.0, 2.0),
        (exercises.width_at_twice_range_and_speed, 1, 0.5),
        (exercises.depth_for_span, 244.0, 282.0),
        (exercises.speed_for_one_degree, 21.4, 26.2),
    ],
)
def test_answers_are_judged(exercise, right, wrong):
    assert exercise(right).right
    assert exercise(wrong).status == "look again" and exercise(wrong).hint
    assert exercise(...).status == "not answered yet"


def test_the_designed_depth_gives_the_span():
    deep = PassingVessel(sensor_depth=243.5)
    ratio = geometry(deep, 60.0).slant_range / closest_approach(deep).slant_range
    assert 20 * np.log10(ratio) == pytest.approx(6, abs=0.01)


def test_twice_as_far_and_twice_as_fast_is_as_wide_and_6_db_fainter():
    time = np.linspace(-60, 60, 12001)
    curves = [-10 * np.log10(h**2 + (v * time) ** 2) for h, v in ((150.0, 10.0), (300.0, 20.0))]
    one, other = (np.ptp(time[curve > curve.max() - 3]) for curve in curves)
    assert exercises.width_at_twice_range_and_speed(other / one).right
    assert exercises.peak_at_twice_the_range(curves[1].max() - curves[0].max()).right


def test_at_the_speed_found_the_delay_costs_a_degree():
    vessel = PassingVessel(
        speed=21.4, start=(-24.64 - 21.4 * 19 * np.cos(np.pi / 18), 139.74 - 21.4 * 19 * 0.1736)
    )
    closest = closest_approach(vessel)
    now = geometry(vessel, closest.time, retarded=False)
    assert np.degrees(abs(now.azimuth - closest.azimuth)) == pytest.approx(1, abs=0.03)
