"""The pictures of notebook 10 say what their results hold, and move animated artists only."""

import numpy as np
import pytest

from labsim.views.your_own_data import ArrayView, DirectionsView, EchoView

TRACK = np.stack([np.linspace(-200, 100, 61), np.linspace(0, 400, 61)], axis=-1)
TIME = np.linspace(20, 100, 41)


def heard(off=3.0):
    true = np.full(TIME.size, 179.0)
    return dict(
        points=TRACK, time=TIME, true_course_deg=true, course_deg=true - 360 + off, distance_km=8.0,
        bearing_std_deg=0.03,
    )  # fmt: skip


def met(pings=(True, True, False)):
    place = TRACK[:3]
    return dict(
        located=np.concatenate([place, place + 5000]), from_target=np.arange(6) < 3, clutter=1,
        time=np.array([0.0, 8.0, 16.0]), true=place, weight=np.array([0.2, 1.0, 0.1]),
        reported=[place[k : k + 1] + [3, 4] if here else np.zeros((0, 2)) for k, here in enumerate(pings)],
    )  # fmt: skip


def pointed(off=2.0):
    angle = np.full(16, 179.0)
    return dict(
        time=np.arange(16) / 4, azimuth_deg=angle - 360 + off, true_azimuth_deg=angle, angle_deg=angle / 4,
        true_angle_deg=angle / 4, points=TRACK[:16] / 10, track=TRACK[:16] / 10, window=0.25, order="pxyz",
    )  # fmt: skip


CASES = {
    "array": (lambda: ArrayView(TRACK, 120.0), heard, {"off": 9.0}),
    "echo": (lambda: EchoView(TRACK, 16.0), met, {"pings": (True, False, True)}),
    "directions": (lambda: DirectionsView(4.0), pointed, {"off": 90.0}),
}


def test_course_error_is_wrapped_and_its_median_is_said():
    assert "the course to 3° or better" in ArrayView(TRACK, 120.0).draw(heard())


def test_echo_view_counts_the_pings_on_which_the_vessel_is_held():
    sentence = EchoView(TRACK, 16.0).draw(met())
    assert "on 2 of 3 pings" in sentence and "typically 5 m away" in sentence


def test_echo_view_survives_a_filter_that_reports_nobody():
    assert "on 0 of 3 pings" in EchoView(TRACK, 16.0).draw(met((False, False, False)))


def test_azimuth_error_is_wrapped_and_said():
    assert "wrong by 2.0° (RMSE)" in DirectionsView(4.0).draw(pointed())


@pytest.mark.parametrize("case", CASES)
def test_a_slider_step_leaves_the_background_alone(case):
    make, result, change = CASES[case]
    view = make()
    view.draw(result())
    view.figure.canvas.draw()
    view.figure.stale = False
    view.draw(result(**change))
    assert not view.figure.stale
