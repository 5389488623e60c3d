"""The pictures of chapter 06 say what their results say, and move what they should."""

import numpy as np
import pytest

from labsim.lab import still
from labsim.views import course_from_warping as views

TIME = np.linspace(0, 1200, 50)


def png_of(view, result):
    data, metadata = still(view, result)._repr_mimebundle_()
    assert metadata["image/png"]["alt"] == data["text/plain"]
    return data["image/png"]


def test_modes_are_counted_and_the_beat_is_told():
    result = {
        "depth": np.linspace(0, 60, 40), "shapes": np.random.default_rng(1).standard_normal((3, 40)),
        "frequency": 150.0, "water_depth": 45.0, "distance": np.linspace(1e3, 15e3, 30),
        "level_db": np.full(30, -70.0), "band": np.linspace(100, 500, 30), "spectrum_db": np.full(30, -70.0),
        "here": 5e3, "beat": 640.0,
    }  # fmt: skip
    view = views.ModesView()
    assert view.draw(result) == "At 150 Hz this sea traps 3 modes; modes 1 and 2 beat every 640 m."
    assert [len(line.get_xdata()) > 0 for line in view.lines].count(True) == 3
    single = result | {"shapes": result["shapes"][:1], "beat": None}
    assert view.draw(single) == "At 150 Hz this sea traps 1 mode; alone it cannot beat."
    assert [len(line.get_xdata()) > 0 for line in view.lines].count(True) == 1
    deep = result | {"shapes": np.tile(result["shapes"], (5, 1)), "level_db": np.full(30, -200.0)}
    assert "traps 15 modes (the first 12 are drawn)" in view.draw(deep)
    assert np.min(view.level.get_ydata()) == view.ahead.get_ylim()[0]


def test_stripes_follow_their_lines():
    result = {
        "time": TIME, "level_db": np.zeros((50, 30)), "lines": np.outer([200, 300], np.linspace(1, 0.9, 50)),
        "beta": 1.1, "contrast": 0.93,
    }  # fmt: skip
    view = views.StripesView()
    assert "beta = 1.10" in view.draw(result) and "93 %" in view.draw(result)
    assert np.nanmax(view.lines.get_xdata()) == 300
    assert png_of(view, result) != png_of(view, result | {"level_db": np.full((50, 30), 9.0)})


def test_pulses_show_where_the_followed_one_stands():
    delay = np.linspace(0.02, 0.2, 200)
    result = {
        "frequency": np.linspace(200, 400, 50), "spectrum": np.ones(50),
        "warped_frequency": np.linspace(200, 400, 50), "warped": np.ones(50), "delay": delay,
        "first": np.exp(-(((delay - 0.11) / 0.004) ** 2)), "now": np.exp(-(((delay - 0.099) / 0.004) ** 2)),
        "marks": [(0.05, 0.045), (0.07, 0.06), (0.11, 0.1), (0.13, 0.12)], "first_delay": 0.11,
        "now_delay": 0.099, "minute": 12.0, "beta": 1.2, "ratio": 0.9, "true_ratio": 0.891, "pair": "2-4",
    }  # fmt: skip
    view = views.WarpView()
    sentence = view.draw(result)
    assert "stands at 99 ms after 12.0 min" in sentence and "1.0 % from that of the ranges" in sentence
    assert np.allclose(view.peaks.get_ydata(), 1, atol=0.02)


def scene(motion, error_deg):
    courses = {name: np.full(50, 180.0) for name in views.NAMES} | {
        "anchored": np.full(50, 180.0 + error_deg)
    }
    return {
        "time": TIME, "record_db": np.zeros((10, 30)), "bearing_deg": np.linspace(60, 97, 50),
        "delay": np.linspace(0.015, 0.2, 60), "envelope": np.ones((50, 60)), "track": np.full(50, 0.1),
        "ratio": np.ones(50), "true_ratio": np.ones(50), "ratio_error": 0.004, "true_course_deg": 180,
        "courses_deg": courses, "pair": "2-4", "motion": motion,
    }  # fmt: skip


def test_the_scene_names_its_figure_and_the_errors():
    names = {"uniform": "Fig. 4", "accelerating": "Fig. 7"}
    view = views.SceneView(np.linspace(50, 125, 30), np.linspace(0.015, 0.2, 60), names)
    sentence = view.draw(scene("accelerating", 27.3))
    assert "The accelerating vessel: range ratio from pulse 2-4 0.4 % off" in sentence
    assert "the paper's estimator +0.0°" in sentence and "(free) and +27.3° (anchored)" in sentence
    assert view.titles[0].get_text() == "Fig. 7a: the bearing turns"
    view.draw(scene("uniform", -1.0))
    assert view.titles[2].get_text() == "Fig. 4c: range ratio 0.4 % off"
    assert "anchored \N{MINUS SIGN}1.0°" in view.titles[3].get_text()
    view.draw(scene("uniform", 170.0))
    assert np.all(np.isnan(view.lines["anchored"].get_ydata()))


def test_another_vessel_in_the_lab_leaves_the_background_as_it_is():
    view = views.SceneView(np.linspace(50, 125, 30), np.linspace(0.015, 0.2, 60))
    first = png_of(view, scene("uniform", 0.0))
    view.figure.stale = False
    view.draw(scene("accelerating", 0.0) | {"record_db": np.full((10, 30), -1.0)})
    assert not view.figure.stale
    assert png_of(view, scene("accelerating", 0.0) | {"record_db": np.full((10, 30), -1.0)}) != first


def test_errors_are_told_at_the_last_minute():
    rmse = {name: np.geomspace(90, 0.3 + k, 50) for k, name in enumerate(views.NAMES)}
    view = views.ErrorsView()
    sentence = view.draw(
        {"time": TIME, "trials": 12, "rmse_deg": rmse, "bound_deg": np.geomspace(90, 0.25, 50)}
    )
    assert (
        "over 12 trials: the paper's estimator 0.30°, centred 1.3°" in sentence
        and "bound for any speed 0.25°" in sentence
    )
    assert view.title.get_text() == "The paper's estimator ends at 1.2 times the bound"
    worse = {name: 100 * curve for name, curve in rmse.items()}
    sentence = view.draw({"time": TIME, "trials": 12, "rmse_deg": worse, "bound_deg": np.full(50, 0.0151)})
    assert "centred 130°" in sentence and "bound for any speed 0.015°" in sentence


def test_passages_and_sweeps_read_their_results():
    position = np.stack([np.linspace(5e3, -1e3, 50), np.full(50, 8660.0)], axis=-1)
    vessels = {"uniform": (position, np.full(50, 5.0)), "accelerating": (position * 2, np.full(50, 8.0))}
    view = views.PassagesView()
    for _ in range(2):
        sentence = view.draw({"time": TIME, "vessels": vessels})
    assert "the uniform one from 60° to 97°" in sentence
    assert len(view.map.lines) == 8 and len(view.curve.lines) == 2
    assert view.ends["accelerating"].get_xdata() == pytest.approx([-2.0])
    assert np.all(view.speeds["accelerating"].get_ydata() == 8)
    values = np.arange(0, 360, 30)
    curve = 1 + np.abs(np.cos(np.radians(values - 60)))
    sweep = (values, {name: curve for name in views.NAMES}, curve)
    view = views.SweepView()
    for _ in range(2):
        sentence = view.draw({"course (°)": sweep, "first range (km)": sweep, "speed (m/s)": sweep})
    assert [len(axes.lines) for axes in view.rows.ravel()] == [5, 5, 5, 1, 1, 1]
    assert np.array_equal(view.lines["speed (m/s)", "free"].get_ydata(), curve)
    assert view.rows[1, 2].get_xlim()[1] > 330 and view.rows[1, 2].get_ylim()[1] > curve.max()
    assert "best at 150° and 330°; its error goes from 1.5° to 1.0° as the first range grows" in sentence


def test_the_first_bearing_and_the_recorded_track():
    error = np.linspace(-1, 1, 20)
    result = {"first_deg": error, "paper_deg": 1.25 * error, "centred_deg": 0 * error, "slope": 1.25,
              "course_deg": 180, "share": 0.87}  # fmt: skip
    view = views.FirstBearingView()
    assert "brings 87 % of the variance" in view.draw(result)
    assert view.line.get_ydata()[1] / view.line.get_xdata()[1] == pytest.approx(1.25)
    track = np.stack([np.linspace(900, 1200, 50), np.linspace(7800, 8300, 50)], axis=-1)
    recorded = {"time": TIME, "points": track, "course_deg": TIME, "true_course_deg": TIME, "off_deg": 3.2,
                "window": 40}  # fmt: skip
    view = views.RecordedView(track, 120.0)
    sentence = view.draw(recorded | {"course_deg": np.linspace(-180, 180, 50)})
    assert sentence == "Windows of 40 frames give the course of the recorded track to 3° (median)."
    low, high = view.curve.get_ylim()
    assert low <= np.min(view.course.get_ydata()) and np.max(view.course.get_ydata()) < high
