"""Feedback on the exercises of chapter 01."""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from labsim.checks import check_number
from labsim.noise import decibels
from labsim.vector_sensor import PassingVessel, closest_approach, geometry, snr


def times_farther(answer):
    """Slant range at the end of the minute over that at the closest approach."""
    vessel = PassingVessel()
    expected = geometry(vessel, 60.0).slant_range / closest_approach(vessel).slant_range
    return check_number(
        answer,
        expected,
        0.05,
        "the SNR falls by 20 log10 of the ratio of the distances; read both ends of the curve",
        [
            (
                expected**2,
                "that is the ratio of the powers; the pressure falls as 1/r, so power falls as 1/r²",
            ),
            (1 / expected, "the other way round: the distance at the end over the closest one"),
        ],
    )


def peak_at_twice_the_range(answer):
    """Change of the peak of the SNR curve, dB, when closest slant range and speed both double."""
    expected = decibels(1 / 2**2)
    mistakes = [
        (decibels(1 / 2), "pressure falls as 1/r, so power falls as 1/r²"),
        (-expected, "farther away is fainter: mind the sign"),
    ]
    return check_number(answer, expected, 0.03, "the peak is as 1/h²; speed has no part in it", mistakes)


def width_at_twice_range_and_speed(answer):
    """Factor of the width of the SNR curve when closest slant range and speed both double."""
    mistakes = [
        (2.0, "a wider pass, yes; but the vessel also runs through it twice as fast"),
        (0.5, "twice as fast, yes; but the way within 3 dB of the peak is twice as long"),
    ]
    return check_number(answer, 1.0, 0.03, "the width is as h / v", mistakes)


def level_span_db(vessel):
    """How far the SNR falls from the closest approach to the end of the record, dB."""
    return float(vessel.snr_db - decibels(snr(vessel, vessel.duration)))


def depth_for_span(answer, span_db=6.0):
    """Sensor depth at which the paper's vessel fades by `span_db` from closest approach to the end, m."""
    expected = brentq(
        lambda depth: level_span_db(replace(PassingVessel(), sensor_depth=depth)) - span_db, 1, 2000
    )
    closest = closest_approach(PassingVessel(sensor_depth=expected))
    slant = float(closest.slant_range)
    mistakes = [(slant, "that is the slant range at the closest approach; the depth is its vertical part")]
    hint = "the horizontal distances do not change with depth; solve 20 log10 (slant range ratio) = the span"
    return check_number(answer, expected, 0.03, hint, mistakes)


def speed_for_one_degree(answer):
    """Speed at which the delay turns the azimuth by one degree at the closest approach, m/s."""
    vessel = PassingVessel()
    closest = closest_approach(vessel)
    horizontal = np.linalg.norm(closest.position)
    delay = closest.time - closest.emitted
    mistakes = [
        (
            np.radians(1) * vessel.sound_speed,
            "the sound travels the slant range, the azimuth turns in the plane",
        ),
        (1 * horizontal / delay, "one degree is 0.0175 radians"),
    ]
    hint = "abeam the azimuth turns at speed / horizontal distance; multiply by the travel time of the sound"
    return check_number(answer, np.radians(1) * horizontal / delay, 0.03, hint, mistakes)
