"""The pictures of chapter 05 say what their results hold, and move animated artists only."""

import numpy as np
import pytest

from labsim.operator_display import Reading
from labsim.views import delay_tracking_loop as views

TIME = np.arange(20) + 0.5
ERROR = np.linspace(-500e-6, 500e-6, 21)


def discriminator(now=60e-6):
    curve = 4 / 9425 * np.sin(9425 * ERROR)
    return dict(
        error=ERROR, measured=curve, exact=curve, tangent=4 * ERROR, now=now, push=222e-6,
        peak=1 / 6000, cliff=1 / 3000, seconds=1.0,
    )  # fmt: skip


def response():
    return dict(
        time=TIME, truth=0 * TIME, theory=0 * TIME, mean=0 * TIME, trials=np.zeros((20, 3)),
        time_constant=0.3, left=-0.2e-6, jitter=4.2e-6, slipped=0.0,
    )  # fmt: skip


def tuning(revealed=True):
    x = np.geomspace(0.03, 2, 9)
    return dict(
        constants=x, lags=1e-4 * x, jitters=1e-5 / x, totals=1e-4 * x, revealed=revealed, time_constant=0.06,
        best=0.204, lag=4e-6, jitter3=54e-6, total=58e-6, least=41e-6, slipped=0.0,
    )  # fmt: skip


def manoeuvre():
    names = ("simple loop", "loop with memory", "Kalman tracker")
    rms = dict(zip(names, (14e-6, 11.5e-6, 11.3e-6), strict=True))
    return dict(time=TIME, errors={name: 0 * TIME for name in names}, turns=(8, 16), rms=rms)


def fade():
    return dict(
        time=TIME, errors=np.zeros((20, 4)), fade=(1, 3), peak=1 / 6000, cliff=1 / 3000, lost=0.5, limit=1.0
    )


def capture():
    return dict(
        time=TIME, crossing=0 * TIME, delays=np.zeros((20, 4)), captured=0.25, power=1.5, speed=150e-6,
        period=667e-6,
    )  # fmt: skip


def sweeps():
    level = np.where((TIME > 5) & (TIME < 10), 0.1, 1)[:, None]
    zones = {"1 clear": (0, 5), "2 fade": (5, 10)}
    return dict(offsets=ERROR, time=TIME, sweeps=-level * np.sin(9425 * ERROR), picks=0 * TIME, zones=zones)


def running():
    return dict(
        time=TIME, readings=np.full(20, 5e3), average=np.full(20, 8e3), operator=np.full(20, 5e3), truth=5e3
    )


def chart():
    return dict(time=TIME, curvature=np.append(np.full(19, 2e-4), np.nan), unit=4e3)


def desk(revealed=True, kept=20, found=5020.0):
    reading = Reading(np.full(20, 2e-4), np.arange(20) < kept, np.full(20, 2e-4), found)
    curves = np.tile(-np.sin(9425 * ERROR), (2, 20, 1))
    return dict(
        time=TIME, offsets=ERROR, curves=curves, picks=np.full((2, 20), 20e-6), masks=((3, 5), (9, 12)),
        reading=reading, unit=4e3, read_off=5000.0, revealed=revealed, truth=5001.0,
        machine=np.full(20, 1e-4), scores={"your reading": -0.0002, "machine": 0.63},
    )  # fmt: skip


CASES = {
    "discriminator": (views.DiscriminatorView, discriminator, ["+60 µs", "pushes back", "1.0 s"]),
    "response": (views.ResponseView, response, ["0.30 s", " 0 µs behind", "4 µs"]),
    "tuning": (views.TuningView, tuning, ["0.06 s", "58 µs in all", "41 µs at 0.20 s"]),
    "manoeuvre": (views.ManoeuvreView, manoeuvre, ["simple loop 14.0", "Kalman tracker 11.3"]),
    "fade": (views.FadeView, fade, ["2.0 s", "2.0 times", "50 % of the loops"]),
    "capture": (views.CaptureView, capture, ["1.5 times", "150 µs/s", "25 %"]),
    "sweeps": (views.SweepsView, sweeps, ["20 sweeps", "vanish in zone 2 fade"]),
    "running": (views.RunningAverageView, running, ["+60 %", "0 %"]),
    "chart": (views.ChartView, chart, ["19 readings", "5.0 km"]),
    "desk": (views.OperatorView, desk, ["20 of 20 s", "5.02 km", "+0.0 %", "machine +63.0 %"]),
}


@pytest.mark.parametrize("name", CASES)
def test_the_sentence_says_what_the_result_holds(name):
    view, result, words = CASES[name]
    sentence = view(result()).draw(result())
    for word in words:
        assert word in sentence, sentence


@pytest.mark.parametrize("name", CASES)
def test_drawing_moves_animated_artists_only(name):
    make, result, _ = CASES[name]
    view = make(result())
    view.draw(result())
    view.figure.canvas.draw()
    view.figure.stale = False
    view.draw(result())
    assert not view.figure.stale


@pytest.mark.parametrize(
    "now, words", [(60e-6, "the harder"), (200e-6, "but weaker"), (-400e-6, "wrong way")]
)
def test_the_discriminator_is_told_in_three_regions(now, words):
    assert words in views.DiscriminatorView(discriminator()).draw(discriminator(now))


def test_theory_is_shown_only_when_revealed():
    view = views.TuningView(tuning())
    assert "best" not in view.draw(tuning(revealed=False))
    assert not view.totals.get_visible()
    assert "best" in view.draw(tuning(revealed=True))


def test_the_desk_hides_the_truth_until_asked():
    view = views.OperatorView(desk())
    assert "truth" not in view.draw(desk(revealed=False))
    assert np.all(np.isnan(view.truth.get_ydata()))


def test_the_desk_without_a_range_says_so():
    view = views.OperatorView(desk())
    sentence = view.draw(desk(revealed=False, kept=0, found=np.nan))
    assert "0 of 20 s" in sentence and "no range" in sentence and "nan" not in sentence
    score = {"scores": {"the line": np.nan}}
    assert "the line no range" in view.draw(desk(kept=0, found=np.nan) | score)


@pytest.mark.parametrize("name", ["response", "tuning"])
def test_loops_that_slipped_are_counted(name):
    make, result, _ = CASES[name]
    view = make(result())
    assert "slipped" not in view.draw(result())
    assert "25 % of the loops have slipped" in view.draw(result() | {"slipped": 0.25})


def test_measured_errors_beyond_the_axes_are_drawn_at_their_edge():
    view = views.TuningView(tuning())
    view.draw(tuning() | {"total": 1570e-6, "lag": 1e-6})
    low, high = view.total.axes.get_ylim()
    assert low < view.lag.get_ydata()[0] < view.total.get_ydata()[0] < high


def test_a_jump_answered_downwards_stays_inside_the_axes():
    view = views.ResponseView(response())
    for lowest in (0.0, -336e-6, 0.0):
        view.draw(response() | {"trials": np.full((20, 3), lowest)})
        low, high = view.mean.axes.get_ylim()
        assert low < 1e6 * lowest and (lowest < 0) == (low < -100)


def test_the_chart_is_linear_in_curvature():
    axes = views.ChartView(chart()).figure.axes[0]
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels == ["∞", "80", "20", "12", "8", "6", "4"]
    np.testing.assert_allclose(axes.get_yticks(), [0, 1 / 20, 1 / 5, 1 / 3, 1 / 2, 2 / 3, 1])
