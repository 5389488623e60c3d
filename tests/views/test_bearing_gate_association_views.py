"""The pictures of chapter 07 say what their results hold, and a slider moves animated artists alone."""

import numpy as np
import pytest

from labsim.bearing_gate import FALSE_ALARM, NOTHING
from labsim.views import bearing_gate_association as views

TIME = np.arange(0.0, 361.0, 3.0)


def gate(theta_deg=30, target_range=9_000.0, own_deg=3.5):
    return dict(
        theta=np.radians(theta_deg), error=0.05, baseline=1_000.0, low=7_000.0, up=np.inf,
        target_range=target_range, lower=np.radians(-6.0), upper=np.radians(11.05), own=np.radians(own_deg),
        ranges=np.linspace(500, 15_000, 20), parallaxes=np.linspace(0.5, 0.05, 20),
    )  # fmt: skip


def over_time(shift_deg=0.0):
    second = np.radians(np.full((TIME.size, 4), 90.0)) + np.radians(np.arange(4))
    return dict(
        time=TIME, second=second, source=1,
        lower=second[:, 1] - 0.1 + np.radians(shift_deg) * (TIME > 200),
        upper=second[:, 1] + 0.1 + np.radians(shift_deg) * (TIME > 200),
    )  # fmt: skip


def covered(coverage=0.97):
    return dict(
        offsets=np.linspace(-0.4, 0.7, 50), density=np.ones(50), lower=-0.1, upper=0.2, coverage=coverage,
        ranges=np.linspace(500, 15_000, 20), coverages=np.linspace(0, 1, 20), both_within=0.466,
        target_range=12_000.0, low=7_000.0, bounds=1.0,
    )  # fmt: skip


def pairs(partner=(0, 1, 2)):
    bearings = np.radians([90.0, 100.0, np.nan])
    return dict(
        first=bearings, second=np.radians([88.0, 99.0, 150.0]), lower=bearings - 0.1, upper=bearings + 0.1,
        first_source=np.array([0, 1, NOTHING]), second_source=np.array([0, 1, FALSE_ALARM]),
        partner=np.array(partner), rates={"correct": 1.0 if partner[0] == 0 else 0.0},
    )  # fmt: skip


@pytest.mark.parametrize(
    "view, one, other, words",
    [
        (views.GateView, gate(), gate(-40, 2_000.0, 20.0), ("6.0° counter-clockwise", "11.1° clockwise")),
        (views.GateTimeView, over_time(), over_time(20.0), ("torpedo 2", "100% of the scans before 100 s")),
        (views.CoverageView, covered(), covered(0.5), ("12.0 km", "probability 0.97", "0.47")),
        (
            views.PairingView,
            pairs(),
            pairs((1, 0, -1)),
            ("Of 2 sources", "2 found their own bearing", "0 wrong pairs"),
        ),
    ],
)
def test_sentences_follow_the_result_and_steps_keep_the_background(view, one, other, words):
    view = view()
    said = view.draw(one)
    assert all(word in said for word in words) and said.endswith(".")
    view.figure.canvas.draw()
    view.figure.stale = False
    assert view.draw(other) != said
    assert not view.figure.stale


def test_a_target_outside_its_gate_is_said_to_be_outside():
    view = views.GateView()
    assert "outside the gate" in view.draw(gate(own_deg=20.0))
    assert "inside the gate" in view.draw(gate(own_deg=-5.0))


def test_wrong_pairs_are_counted_in_good_english():
    assert "makes 2 wrong pairs." in views.PairingView().draw(pairs((1, 0, -1)))
    assert "makes 1 wrong pair." in views.PairingView().draw(pairs((0, 2, -1)))


def test_edges_are_said_with_their_side_and_nothing_is_minus_zero():
    gate_ahead = gate(own_deg=-1e-9) | dict(lower=np.radians(2.4), upper=np.radians(9.0))
    said = views.GateView().draw(gate_ahead)
    assert "runs from 2.4° clockwise to 9.0° clockwise" in said and "is seen 0.0° from it, outside" in said


def test_both_torpedoes_gates_are_counted_apart():
    second = np.radians(np.full((TIME.size, 4), 90.0))
    width = np.radians([5.0, 5.0, 5.0, 5.0])
    late = np.radians(20.0) * (TIME > 280)[:, None] * [0, 1, 0, 0]
    gates = {
        "minimum range": (second + late - width, second + late + width),
        "range bounds": (second - 1, second + 1),
    }
    said = views.TwoGatesView().draw(dict(time=TIME, second=second, gates=gates))
    share = np.mean(TIME[TIME >= 200] <= 280)
    assert f"100% and {share:.0%} with the gate from minimum range; 100% and 100% with" in said


def test_bars_name_the_best_rule_of_each_condition():
    rates = dict(correct=0.7, null=0.0, ambiguous=0.0, missed=0.0, false=0.3)
    result = {"clean\nearly": {"one": rates, "two": rates | {"correct": 0.8, "false": 0.2}}}
    result["clean\nlate"] = {"one": rates, "two": rates | {"correct": 0.1, "false": 0.9}}
    said = views.RulesView(result, ("one", "two")).draw(result)
    assert said == "The rule with the most right pairs: two (clean, early); one (clean, late)."


def test_the_still_pictures_say_their_numbers():
    theta = np.radians(np.concatenate([np.linspace(-160, -20, 10), np.linspace(20, 160, 10)]))
    sizes = dict(
        theta=theta, size_by_theta=np.full(20, 0.3),
        low=np.linspace(3e3, 9e3, 5), size_by_low=np.ones((4, 5)),
        baseline=np.linspace(50, 900, 5), size_by_baseline=np.ones((4, 5)), labels="abcd",
        largest=np.radians(18.56), where=np.radians(80.4),
    )  # fmt: skip
    assert "18.56°, at θ = ±80.4°" in views.GateSizeView().draw(sizes)
    bearing = np.radians(np.linspace(20, 150, 4 * TIME.size).reshape(-1, 4))
    scene = dict(tracks=np.ones((4, 9, 2)), own=np.ones((9, 2)), time=TIME, bearing=bearing)
    assert "between 20° and 150°" in views.SceneView().draw(scene)
    shown = dict(
        time=TIME, second=bearing, labels=["1 scan", "10 scans", "ranges"], starts=[TIME] * 3,
        correct=[np.full(TIME.size, share) for share in (0.9, 0.53, 0.78)], crossing=(177, 237),
    )  # fmt: skip
    said = views.TracksView().draw(shown)
    assert "Between 177 and 237 s" in said and "53% right" in said and "78%" in said
