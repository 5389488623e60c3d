"""Feedback on the exercises of chapter 04."""

import numpy as np

from labsim import passive_ranging as pr
from labsim.checks import check_choice, check_number

MEASURED = (9.3080e-3, 9.0673e-3)


def tolerance_at_8_km(answer):
    """The largest broadside displacement, mm, for a range error of 5 % at 8 km, broadside, arms of 50 m."""
    per_metre = pr.displacement_ratio(pr.Triplet(displacement=(0, 1, 0)), 8e3, 0.0)
    expected = 1000 * 0.05 / per_metre
    return check_number(
        answer,
        expected,
        0.08,
        "solve 2 d R / a² = 0.05 for d, and give it in millimetres",
        mistakes=(
            (expected / 1000, "that is in metres; the answer is wanted in millimetres"),
            (expected / 10, "that is in centimetres; the answer is wanted in millimetres"),
            (2 * expected, "the displacement counts twice: r1 + r3 - 2 r2 holds H2 two times"),
        ),
    )


def pitch_that_costs_one_percent(answer):
    """The pitch, degrees, at which the printed formula is 1 % off for a target broadside at 5 km."""
    expected = np.degrees(np.arcsin(np.sqrt(0.01)))
    return check_number(
        answer,
        expected,
        0.03,
        "the printed numerator has cos²(pitch) where 1 is right: how large may sin²(pitch) be?",
        mistakes=((np.radians(expected), "that is in radians"),),
    )


def range_from_two_delays(answer):
    """The range, m, for tau12 = 9.3080 ms and tau23 = 9.0673 ms, arms of 50 m, 1500 m/s, level."""
    tau, eps = pr.mean_and_difference(*MEASURED)
    expected = float(pr.range_from_delays(pr.Triplet(), tau, eps))
    cosine = np.cos(pr.bearing_from_delay(pr.Triplet(), tau))
    return check_number(
        answer,
        expected,
        0.005,
        "first the bearing from the mean, then a² cos²(bearing) / (c (tau12 - tau23))",
        mistakes=(
            (expected / cosine**2, "the line is seen foreshortened: cos² of the bearing is missing"),
            (expected / cosine, "the cosine of the bearing enters squared"),
            (expected / 1000, "that is in kilometres; the answer is wanted in metres"),
        ),
    )


def what_to_average(answer):
    """Which of "range", "curvature" or "delay difference" may be averaged for a target at rest; two may."""
    if isinstance(answer, str) and answer == "delay difference":
        answer = "curvature"
    return check_choice(
        answer,
        "curvature",
        ("range", "curvature", "delay difference"),
        "which of them is the measured quantity times a constant, and which its inverse?",
    )
