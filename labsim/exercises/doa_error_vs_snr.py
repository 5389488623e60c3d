"""Feedback on the exercises of chapter 02."""

import numpy as np
from scipy.optimize import brentq

from labsim.checks import check_number
from labsim.noise import power_ratio
from labsim.vector_sensor import (
    PassingVessel,
    best_window,
    bisector_lag,
    cramer_rao_bound,
    geometry,
    intensity_error,
    snr,
)


def rmse_at_17_db(answer):
    """RMSE of the angle from the vertical, degrees: 17 dB, 600 Hz, half a second, equal noises."""
    expected = np.degrees(intensity_error(power_ratio(17), 300))
    mistakes = [
        (expected / np.sin(np.radians(60)), "that is the azimuth; the angle itself has no 1/sin"),
        (np.radians(expected), "that is in radians"),
        (np.degrees(intensity_error(10 ** (17 / 20), 300)), "17 dB is a power ratio of 10^1.7, not 10^0.85"),
        (expected * np.sqrt(2), "the noise has 2 B T degrees of freedom, not B T"),
    ]
    hint = "start from the 0.235° at 20 dB: 3 dB more noise costs the square root of 2"
    return check_number(answer, expected, 0.02, hint, mistakes)


def bandwidth_for_half_window(answer):
    """Bandwidth that keeps the error when the window is halved from 0.5 s, 600 Hz; in Hz."""
    hint = "only the product B T enters, as long as the SNR inside the band stays the same"
    return check_number(
        answer, 1200.0, 0.01, hint, [(2400.0, "the error falls with the root of B T, as with T")]
    )


def optimal_noise_ratio(answer, excess=0.01):
    """Least Nv/Np for which intensity comes within 1 % (RMSE) of the bound at 0 dB."""

    def over(ratio):
        return intensity_error(1.0, 300, ratio) / cramer_rao_bound(1.0, 300, ratio) - 1 - excess

    expected = brentq(over, 1e-3, 1e6)
    mistakes = [(1 / expected, "the other way round: it is the pressure that must be quiet")]
    hint = "var/bound = (1 + S) G / (1 + S G) with Np = 1 and G = 1 + Np/Nv; set it to 1.01 squared"
    return check_number(answer, expected, 0.05, hint, mistakes)


def best_window_at_30_db(answer, centre=10.0):
    """Best window for the azimuth of the paper's vessel at 30 dB, 10 s into the record, s."""
    vessel = PassingVessel(snr_db=30.0)
    angle = geometry(vessel, centre).angle_from_vertical
    in_one_second = intensity_error(snr(vessel, centre), 600) / np.sin(angle)
    expected = best_window(in_one_second, 800 * bisector_lag(vessel, centre, 0.1)[0])
    hint = "by how much does 16 dB reduce the error of one second, and with what power does it enter T?"
    return check_number(answer, expected, 0.1, hint, [(2.4, "that is the best window at 14 dB")])
