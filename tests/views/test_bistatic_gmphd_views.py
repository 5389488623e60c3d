"""The pictures of chapter 08 say what their results hold, and a slider moves animated artists alone."""

import numpy as np
import pytest

from labsim.views import bistatic_gmphd as views

STATES = np.full((40, 2, 4), 1_000.0)


def located(cover=0.94, impossible=0.0):
    return dict(
        receiver=(0.0, 0.0), source=(4_000.0, 0.0), target=np.array([0.0, 8_000.0]), bearing=np.pi / 2,
        ellipse=np.ones((9, 2)), found=np.full((5, 2), 8_000.0), covariance=np.diag([1e4, 4e4]),
        cover=cover, impossible=impossible,
    )  # fmt: skip


def echoes(count=25, heard=4):
    return dict(now=np.ones((count, 2)), before=np.ones((0, 2)), truth=np.ones((4, 2)), heard=heard)


def stage(weight=(1.0, 0.9, 0.2, 1e-3), name="update"):
    size = len(weight)
    return dict(
        mean=np.zeros((size, 2)), covariance=np.tile(1e4 * np.eye(2), (size, 1, 1)), weight=np.array(weight),
        measured=np.ones((3, 2)), centre=np.zeros(2), stage=name, number=2,
    )  # fmt: skip


def scene(distance=100.0, name="PHD, textbook"):
    return dict(
        reported=np.ones((7, 2)), number=np.full(40, 2), count=np.repeat([2, 1], [30, 10]), name=name,
        weight_sum=np.full(40, 2.0), ospa=np.tile([distance, 60.0, 80.0], (40, 1)),
    )  # fmt: skip


@pytest.mark.parametrize(
    "view, one, other, words",
    [
        (views.EllipseView(), located(), located(0.5, 0.09), ("(0.0, 8.0) km", "holds 94%")),
        (views.EchoesView(), echoes(), echoes(3, 1), ("25 detections", "4 are echoes", "21 are clutter")),
        (
            views.StepView(0.5, 1e-5),
            stage(),
            stage((), "before"),
            ("4 components", "2.10", "2 of them above 0.5"),
        ),
        (views.SceneView(STATES), scene(), scene(50.0, "tracker"), ("OSPA 100 m", "wrong in 25%")),
    ],
)
def test_sentences_follow_the_result_and_steps_keep_the_background(view, one, other, words):
    said = view.draw(one)
    assert all(word in said for word in words) and said.endswith(".")
    view.figure.canvas.draw()
    view.figure.stale = False
    assert view.draw(other) != said
    assert not view.figure.stale


def test_draws_without_a_position_are_mentioned():
    assert "9% of the draws have no position" in views.EllipseView().draw(located(0.8, 0.09))


def test_a_wide_cloud_gets_wider_axes_and_a_narrow_one_gets_them_back():
    view = views.EllipseView()
    for spread, reach in ((100.0, 1.0), (900.0, 4.0), (100.0, 1.0)):
        view.draw(located() | dict(covariance=np.diag([spread**2, 50.0**2])))
        assert view.close.get_xlim() == (-reach, reach)


def test_geometry_says_its_angles_in_degrees():
    shown = dict(
        receiver=(0.0, 0.0), source=(4e3, 0.0), target=(-1_500.0, 4_000.0), velocity=(2.0, 1.0),
        bearing=np.radians(110.6), delay=7.4, to_receiver=np.radians(96), to_source=np.radians(63),
    )  # fmt: skip
    said = views.GeometryView().draw(shown)
    assert "takes 7.4 s" in said and "bearing of 111°" in said and "96°" in said and "63°" in said


def test_the_stage_before_the_step_is_not_called_a_stage_after_it():
    said = views.StepView(0.5, 1e-5).draw(stage(name="before"))
    assert said.startswith("Before the step the mixture has 4")


def test_the_picture_of_a_step_follows_the_thresholds_of_the_model():
    view = views.StepView(0.15, 1e-3)
    assert "3 of them above 0.15" in view.draw(stage())
    heights = {line.get_label(): line.get_ydata()[0] for line in view.stems.get_lines()[1:]}
    assert heights == {"reported above": 0.15, "pruned below": 1e-3}


def test_outlines_have_the_size_of_the_covariance():
    curve = views._outlines(np.zeros((1, 2)), np.diag([9.0, 16.0])[None], 2.0)
    assert np.nanmax(curve[0]) == pytest.approx(6.0) and np.nanmax(curve[1]) == pytest.approx(8.0, rel=1e-3)
    assert np.count_nonzero(np.isnan(curve[0])) == 1


def test_the_still_pictures_say_their_numbers():
    loud = dict(states=np.ones((10, 4, 4)), snr_db=np.linspace(0, 25, 40).reshape(10, 4))
    said = views.LoudnessView().draw(loud | dict(receiver=(0.0, 0.0), source=(4e3, 0.0)))
    assert "from 0 to 25 dB" in said
    curves = {"one": np.full(10, 80.0), "two": np.full(10, 60.0)}
    said = views.ComparisonView().draw(dict(ospa=curves, count=curves, number=np.ones(10)))
    assert said == "Mean OSPA over all scans: two 60 m, one 80 m."
    times = {"update": np.array([1e-3, 2e-3]), "merge": np.array([1e-3, 5e-3])}
    said = views.CostView().draw(dict(components=np.array([25, 800]), times=times))
    assert "with 800 components, the most expensive part was merge." in said
