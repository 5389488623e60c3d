"""Feedback on the exercises of chapter 07."""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from labsim import bearing_gate as bg
from labsim.checks import check_choice, check_number

SCENARIO = bg.AttackScenario()
SIDES = ("clockwise", "counter-clockwise", "both")
RULES = ("nearest bearing", "unique candidate", "nearest gate centre", "assignment")


def moving_edge(answer):
    """Which edge of the gate moves with the minimum range, for a target at theta = -50 degrees."""
    hint = "set θ to -50° in the first lab and move the minimum range: which orange line moves?"
    return check_choice(answer, "counter-clockwise", SIDES, hint)


def three_sigma_gate(answer):
    """Width of the three-sigma minimum-range gate of the paper's arrays at theta = 60 degrees, in degrees."""
    arrays = SCENARIO.baseline, SCENARIO.minimum_range
    bounds = {count: count * SCENARIO.error for count in (1, 3)}
    widths = {n: float(np.degrees(bg.gate_size(np.radians(60), b, b, *arrays))) for n, b in bounds.items()}
    mistakes = [
        (widths[1], "that is the one-sigma gate"),
        (
            3 * widths[1],
            "the parallax does not grow with sigma: only the margins do, and the place it is taken",
        ),
        (4 * 3 * SCENARIO.error_deg, "that is the margins alone; the parallax is missing"),
    ]
    return check_number(answer, widths[3], 0.01, "use gate_size with bounds of three times 3°", mistakes)


def time_to_failure(answer):
    """Seconds from 7 km until the two-sigma gate holds a target abeam, closing at 30 m/s, half the time."""
    sigma, low = SCENARIO.error, SCENARIO.minimum_range

    def excess(target_range):
        coverage = bg.gate_coverage(-np.pi / 2, target_range, sigma, sigma, 2.0, SCENARIO.baseline, low)
        return float(coverage) - 0.5

    failing = brentq(excess, 1_000.0, low)
    expected = (low - failing) / 30
    mistakes = [
        (failing, "that is the range; the torpedo began at the minimum range and closes at 30 m/s"),
        (failing / 30, "count from the minimum range, not from the array"),
    ]
    hint = "find the range at which gate_coverage is one half, then divide the distance run by the speed"
    return check_number(answer, expected, 0.03, hint, mistakes)


def rule_in_clutter(answer):
    """The rule with the most right pairs, first 100 s, with false alarms and every fourth source missed."""
    rates = rates_in_clutter()
    hint = "simulate it: replace(scenario, false_alarms=4.0, detection_probability=0.75), then pairing_rates"
    answer = "assignment" if isinstance(answer, str) and answer.startswith("assignment") else answer
    return check_choice(answer, max(rates, key=rates.get), RULES, hint)


def rates_in_clutter():
    """Share of right pairs for each of RULES; two-sigma range-bounded gates, 40 runs, seed 74."""
    scenario = replace(SCENARIO, false_alarms=4.0, detection_probability=0.75)
    time = scenario.time[scenario.time < 100]
    scans = bg.simulate_scans(np.random.default_rng(74), scenario, time, 40)
    gate = bg.scan_gates(scenario, scans, 2.0, "range bounds")
    allowed, centre = bg.in_gate(gate, scans.second), sum(gate) / 2
    partners = (
        bg.nearest_bearing(scans.first, scans.second),
        bg.unique_candidate(allowed),
        bg.nearest_bearing(centre, scans.second, allowed),
        bg.global_assignment(bg.squared_difference(centre, scans.second, allowed)),
    )
    return {
        rule: bg.pairing_rates(partner, scans)["correct"]
        for rule, partner in zip(RULES, partners, strict=True)
    }
