"""Feedback on the exercises of chapter 08."""

import numpy as np

from labsim import bistatic as bs
from labsim.checks import check_number
from labsim.gmphd import PhdModel

SCENARIO = bs.BistaticScenario()
MODEL = PhdModel()


def range_abeam(answer):
    """Distance of a target at a bearing of 90 degrees whose echo takes 8 s, m."""
    path = SCENARIO.sound_speed * 8.0
    expected = float(bs.ellipse_range(np.pi / 2, 8.0, *SCENARIO.geometry))
    mistakes = [
        (path / 2, "half the path is the range of a sonar whose source and receiver are at one place"),
        (path, "that is the whole path, from the source to the target and on to the receiver"),
    ]
    hint = "put the cosine of 90 degrees into equation (9): what is left in the denominator?"
    return check_number(answer, expected, 0.005, hint, mistakes)


def weight_after_misses(answer):
    """Weight of a certain target, weight 1, after two scans without a detection."""
    miss = MODEL.survival * (1 - MODEL.detection)
    mistakes = [
        ((1 - MODEL.detection) ** 2, "almost: between two scans the target must also survive, P_S"),
        (miss, "that is one miss"),
        (1 - MODEL.detection, "that is one miss, without survival"),
    ]
    return check_number(answer, miss**2, 0.005, "each miss multiplies the weight by P_S (1 - P_D)", mistakes)


def misses_until_pruned(answer):
    """How many scans without a detection until a certain target, weight 1, is pruned."""
    expected = int(np.floor(np.log(MODEL.prune_below) / np.log(MODEL.survival * (1 - MODEL.detection)))) + 1
    mistakes = [
        (
            expected - 1,
            "after that many it is still above the threshold, though by less than one more miss takes",
        )
    ]
    hint = "find the first power of P_S (1 - P_D) below 1e-5"
    return check_number(answer, expected, 1e-9, hint, mistakes)


def clutter_that_fills_the_gate(answer):
    """Clutter rate per scan at which a gate holds one false detection on average.

    The innovation has the standard deviation 100 m in x and in y; clutter is taken as uniform.
    """
    discs = bs.region_area(SCENARIO) / (np.pi * 100.0**2)
    expected = discs / MODEL.gate
    mistakes = [
        (discs, "the gate is d² < 20: its radius is √20 spreads"),
        (discs / MODEL.gate**2, "20 is the square of the gate's radius, in spreads"),
    ]
    hint = "divide the area of the region, bs.region_area(scene), by that of the gate, a disc"
    return check_number(answer, expected, 0.02, hint, mistakes)
