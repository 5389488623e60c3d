"""Feedback on the exercises of chapter 05."""

import numpy as np

from labsim import delay_tracking as dt
from labsim.checks import check_number
from labsim.discriminator import Pair
from labsim.passive_ranging import Triplet


def longest_fade(answer):
    """The paper's longest fade, s, for an unknown rate of 40 us/s at 1500 Hz."""
    expected = float(dt.maximum_fade(Pair(), 40e-6))
    return check_number(
        answer,
        expected,
        0.01,
        "the error 40 us/s times t may grow to 1 / (4 f0)",
        mistakes=(
            (2 * expected, "that is the cliff, 1 / (2 f0); the paper's formula stops at the peak"),
            (1e-6 * expected, "mind the micro: 40 us/s is 40e-6"),
        ),
    )


def printed_over_mended(answer):
    """The printed K over the mended one for a noise ratio of 0.1."""
    pair = Pair(noise_power=0.1)
    expected = dt.loop_constant_as_printed(pair) / dt.loop_constant(pair)
    return check_number(
        answer,
        expected,
        0.01,
        "(2 + 2 rho + rho²) / (2 rho + rho²)",
        mistakes=(
            (1 / expected, "the other way round"),
            (np.sqrt(expected), "K is a variance, not its root"),
        ),
    )


def best_time_constant(answer):
    """The best time constant, s, for a noise ratio of 3 and 30 us/s."""
    pair = Pair(noise_power=3.0)
    expected = float(dt.best_time_constant(dt.loop_constant(pair), 30e-6))
    printed = float(dt.best_time_constant(dt.loop_constant_as_printed(pair), 30e-6))
    return check_number(
        answer,
        expected,
        0.01,
        "(9 K / (4 rate²))^(1/3), with K of dt.loop_constant(replace(pair, noise_power=3.0))",
        mistakes=((printed, "that is with the printed K"),),
    )


def bearing_of_the_wrong_stripe(answer):
    """The bearing error, degrees, near broadside, of one whole period in both delays."""
    array = Triplet()
    expected = np.degrees(array.sound_speed / Pair().centre_frequency / array.spacing)
    return check_number(
        answer,
        expected,
        0.03,
        "both delays, so their mean too, are wrong by 1 / f0; the bearing is c tau / a near broadside",
        mistakes=(
            (expected / 2, "the mean of two delays that are each wrong by 1 / f0 is wrong by 1 / f0"),
            (np.radians(expected), "that is in radians"),
        ),
    )
