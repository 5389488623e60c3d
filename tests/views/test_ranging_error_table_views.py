"""The pictures of chapter 04 say what their results hold, and move animated artists only."""

import numpy as np
import pytest

from labsim.passive_ranging import Triplet, ranging_error_table
from labsim.views.ranging_error_table import (
    AveragingView,
    BudgetView,
    ErrorTableView,
    VerticalBeamView,
    WavefrontView,
    percent,
)

RANGES, BEARINGS = np.array([1e3, 2e3, 5e3, 10e3]), np.radians([0, 30, 60])


def wavefront(estimate=4808.0):
    along = np.linspace(-80, 80, 9)
    return dict(
        target_range=5e3, bearing=0.2, spacing=50.0, displacement=0.01, along=along, bend=along**2 / 1e4,
        outer_bend=0.25, estimate=estimate,
    )  # fmt: skip


def table(displacement=0.01):
    made = ranging_error_table(Triplet(), RANGES, BEARINGS, [displacement])
    return dict(table=made, ranges=RANGES, bearings=BEARINGS, displacement=displacement, spacing=50.0)


def budget(error=-0.041):
    ranges = np.linspace(200, 15e3, 20)
    line = np.full(20, error)
    causes = {"tilt": 0.0, "H2 broadside": error, "jitter": 0.0075}
    return dict(
        ranges=ranges, exact=line, first_order=line, jitter=0.01 * abs(line), target_range=5e3, error=error,
        causes=causes,
    )  # fmt: skip


def averages():
    return dict(
        of_range=np.full(10, 1.047), of_curvature=np.full(10, 0.99999), noise=0.2, samples=100,
        edges=np.linspace(0.7, 1.6, 11),
    )  # fmt: skip


def beam():
    return dict(
        elevation_deg=np.linspace(-30, 30, 7), pattern=np.ones(7), arrivals_deg=[0, 8, -12],
        levels=np.array([1, 0.1, 0.0]), bearing_pull_deg=-0.42, range_error=0.007, width_deg=14.5,
    )  # fmt: skip


CASES = {
    "wavefront": (WavefrontView, wavefront, ["5.0 km", "25.0 cm", "+1.0 cm", "-3.8 %"]),
    "table": (lambda: ErrorTableView(table()), table, ["+1.0 cm", "10 km, 60°", "along the line", "-21.7 %"]),
    "budget": (lambda: BudgetView(budget()), budget, ["-4.1 %", "H2 broadside"]),
    "averages": (lambda: AveragingView(averages()), averages, ["20 %", "100 readings", "+4.7 %", "+0.0 %"]),
    "beam": (lambda: VerticalBeamView(beam()), beam, ["10 dB (surface)", "50 dB", "-0.42°", "+0.7 %"]),
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


def test_infinite_and_impossible_ranges_are_drawn_and_said_as_such():
    assert percent(np.nan) == "behind" and percent(np.inf) == "infinite"
    assert "behind" in WavefrontView().draw(wavefront(np.nan))
    assert "behind" in ErrorTableView(table()).draw(table(-0.5))
    assert "infinite" in BudgetView(budget()).draw(budget(np.inf))
    for error in (np.nan, np.inf):
        view = BudgetView(budget())
        view.draw(budget(error))
        view.figure.canvas.draw()


def test_cells_without_a_range_say_behind():
    assert ErrorTableView.words(np.nan, -277.1) == ("behind", "(-277.1)")
    assert ErrorTableView.words(np.inf, -100.0) == ("∞", "(-100.0)")
    assert ErrorTableView.words(-3.84, -4.0) == ("-3.84", "(-4.0)")


def test_numbers_stand_in_the_middle_of_their_cells():
    view = ErrorTableView(table())
    view.light.write([((4, 2), 0, "-3.84"), ((4, 2), 1, "(-4.0)")])
    box = view.light.patch.get_path().get_extents()
    middle = view.axes.transData.transform((4, 2))
    assert (box.x0 + box.x1) / 2 == pytest.approx(middle[0], abs=2)
    assert (box.y0 + box.y1) / 2 == pytest.approx(middle[1], abs=4)
    view.light.write([])
    assert len(view.light.patch.get_path()) == 1
