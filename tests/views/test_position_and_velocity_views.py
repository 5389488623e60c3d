"""The pictures of chapter 03 say what their results hold, and move animated artists only."""

import numpy as np
import pytest

from labsim.views.position_and_velocity import AssumptionView, ComparisonView, FitView, ScatterView

TIME = np.arange(0.25, 60, 0.5)
TRUTH = np.stack([12 * TIME - 250, np.full(TIME.size, 100.0)], axis=-1)


def scatter():
    error = np.stack([TIME, 0.1 * TIME], axis=-1)
    return dict(snr_db=14, truth=TRUTH, points=TRUTH, slant_range=100 + TIME, error=error, theory=error)


def fit():
    error = np.broadcast_to([4.26, 0.333], (TIME.size, 2))
    return dict(
        fit="Line", ahead=False, abeam=20.0, time=TIME, truth=TRUTH, points=TRUTH, fitted=TRUTH, speed=12.0,
        velocity=error, error=error, bound=np.full(TIME.size, 0.14), runs=20,
    )  # fmt: skip


def comparison():
    errors = {
        name: np.full(TIME.size, value) for name, value in zip("abcd", (160.4, 1.0, 0.2, 0.05), strict=True)
    }
    return dict(snr_db=14, time=TIME, abeam=20.0, errors=errors, bound=np.full(TIME.size, 0.049))


def assumption():
    true = np.broadcast_to([12.0, 0.0], TRUTH.shape)
    return dict(
        time=TIME, truth=TRUTH, points=TRUTH, fitted=TRUTH + [3, 4], true_velocity=true, velocity=1.05 * true
    )


CASES = {
    "scatter": (
        ScatterView,
        scatter,
        ["14 dB", "100 m slant range", "0.25 m along", "160 m slant", "60 m along"],
    ),
    "fit": (FitView, fit, ["Line:", "4.3 m/s along", "0.33 m/s across", "20 runs", "0.14 m/s"]),
    "comparison": (
        lambda: ComparisonView(list("abcd")),
        comparison,
        ["after 60 s", "a: 160", "d: 0.05", "0.049."],
    ),
    "assumption": (
        AssumptionView,
        assumption,
        ["From 10 to 60 s", "0.6 m/s", "1.05 times the truth", "course by 0°"],
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_sentence_says_what_the_result_holds(name):
    view, result, words = CASES[name]
    sentence = view().draw(result())
    for word in words:
        assert word in sentence, sentence


@pytest.mark.parametrize("name", CASES)
def test_drawing_moves_animated_artists_only(name):
    make, result, _ = CASES[name]
    view = make()
    view.draw(result())
    view.figure.canvas.draw()
    view.figure.stale = False
    view.draw(result())
    assert not view.figure.stale


@pytest.mark.parametrize("name", ["fit", "assumption"])
def test_gaps_are_drawn_as_gaps(name):
    make, result, _ = CASES[name]
    gap = result()
    for key in ("velocity", "fitted"):
        gap[key] = np.array(gap[key], dtype=float)
        gap[key][:30] = np.nan
    view = make()
    assert "nan" not in view.draw(gap)
    view.figure.canvas.draw()


def test_directions_that_miss_the_surface_are_said_to_do_so():
    result = scatter()
    result["error"] = np.where(np.arange(TIME.size)[:, None] > 100, np.nan, result["error"])
    sentence = ScatterView().draw(result)
    assert sentence.endswith("at 160 m slant range some directions no longer meet the surface.")


def test_what_the_sentence_of_a_fit_adds():
    result = fit()
    assert FitView().draw(result | {"ahead": True}).endswith("m/s (this fit also looks ahead).")
    points = np.where(TIME[:, None] > 37, np.nan, TRUTH)
    assert (
        FitView()
        .draw(result | {"points": points})
        .endswith("Beyond 37 s some directions no longer meet the surface.")
    )


def test_a_fit_without_a_value_at_the_end_is_named():
    result = comparison()
    result["errors"]["b"] = np.where(TIME > 50, np.nan, result["errors"]["b"])
    assert ComparisonView(list("abcd")).draw(result).endswith("(no value at 60 s: b).")


def test_a_course_that_passes_180_degrees_is_not_joined_across_the_picture():
    turn = np.linspace(2.5, 3.5, TIME.size)
    velocity = 12 * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    view = AssumptionView()
    view.draw(assumption() | dict(velocity=velocity))
    drawn = view.found[1].get_ydata()
    assert np.isnan(drawn).sum() == 1 and np.nanmax(np.abs(np.diff(drawn))) < 5


def test_the_title_says_where_the_error_lies():
    view = FitView()
    result = fit()
    view.draw(result)
    assert view.titles[2].get_text() == "Most of the error lies along the track"
    view.draw(result | {"error": result["error"][:, ::-1]})
    assert view.titles[2].get_text() == "Most of the error lies across the track"
    view.draw(result | {"error": np.ones((TIME.size, 2))})
    assert "alike" in view.titles[2].get_text()
