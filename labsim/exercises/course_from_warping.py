"""Feedback on the exercises of chapter 06."""

import numpy as np

from labsim.checks import NOT_ANSWERED, Feedback, check_number
from labsim.course import Passage, bearing_and_range, bearing_and_ratio, centred_course, paper_course
from labsim.metrics import angle_difference
from labsim.warping import follow_pulse, pulse_delay, range_ratio, ratio_error, running_mean
from labsim.waveguide import HorizontalArray, PekerisWaveguide, beam_sound, pressure, solve_modes

COMMON_SCALE = 1.03


def band_constant(answer):
    """The constant C with which warping at beta = 1 keeps the band 150-450 Hz, Hz^2."""
    return check_number(
        answer,
        150.0 * 450.0,
        0.001,
        "at beta = 1 the two limits f2 f1^beta and f1 f2^beta meet",
        mistakes=[
            (300.0**2, "that is the square of the arithmetic mean; the band then slides off to one side"),
            (np.sqrt(150.0 * 450.0), "that is the frequency which stays in place; C is its square"),
        ],
    )


def expected_delay(answer):
    """Delay of pulse 1-3 for a vessel at 7 km in the paper's sea, beta = 1, 200-400 Hz; in ms."""
    sea = PekerisWaveguide()
    expected = 1e3 * pulse_delay(sea, 1, 3, 7e3)
    return check_number(
        answer,
        expected,
        0.01,
        "divide the range by the group speeds of modes 1 and 3 at the geometric mean of the band",
        mistakes=[
            (-expected, "right but for the sign: the higher mode is the slower one, so take t_3 - t_1"),
            (expected / 1e3, "right, but in seconds; the exercise asks for milliseconds"),
            (expected / 0.7, "that is the delay at 10 km; a delay is proportional to range"),
            (1e3 * pulse_delay(sea, 1, 2, 7e3), "that is pair 1-2"),
            (1e3 * pulse_delay(sea, 2, 3, 7e3), "that is pair 2-3"),
        ],
    )


def easiest_course(answer):
    """A course at which the paper's estimator is best, for a vessel first seen at 60 degrees; in degrees."""
    if answer is ... or answer is None:
        return NOT_ANSWERED
    try:
        off = abs((float(answer) - 60.0) % 180.0 - 90.0)
    except (TypeError, ValueError):
        return Feedback("look again", f"the answer must be one number, but it is {answer!r}")
    if off <= 5:
        return Feedback("right", "across the first line of sight an error of the first bearing drops out")
    if off >= 85:
        return Feedback(
            "look again", "along the line of sight the first bearing tilts the course most of all"
        )
    return Feedback("look again", "at which course does cos(theta_0 - course) vanish?")


def common_scale(answer):
    """How far 3 % on all delays but the first moves the paper's course and the centred one, (deg, deg)."""
    if answer is ... or answer is None:
        return NOT_ANSWERED
    try:
        tied, centred = (abs(float(number)) for number in answer)
    except (TypeError, ValueError):
        return Feedback("look again", "the answer must be a pair of numbers: (paper's estimator, centred)")
    expected = common_scale_change()
    if not abs(tied - expected[0]) <= 0.02 * expected[0]:
        return Feedback("look again", "paper's estimator: compare the last course with the one for scale 1")
    if not abs(centred - expected[1]) <= 0.05:
        return Feedback("look again", "centred: the first point must carry the scale like all the others")
    return Feedback(
        "right", "a scale moves every point along its own line of sight: the line keeps its direction"
    )


def common_scale_change():
    """The right pair for `common_scale`, without noise."""
    passage = Passage()
    bearing, ratio = bearing_and_ratio(passage)
    scaled = COMMON_SCALE * ratio
    anchored = np.concatenate([[1.0], scaled[1:]])
    std = (passage.bearing_std, passage.ratio_std)
    moved = [
        angle_difference(f(bearing, new, *std, running=False), f(bearing, ratio, *std, running=False))[0]
        for f, new in ((paper_course, anchored), (centred_course, scaled))
    ]
    return tuple(np.degrees(np.abs(moved)))


def averaging(answer):
    """How many frames to average at -20 dB for a range ratio within 1 %."""
    if answer is ... or answer is None:
        return NOT_ANSWERED
    if not isinstance(answer, (int, np.integer)) or not 1 <= answer <= 400:
        return Feedback("look again", "the answer must be a whole number of frames between 1 and 400")
    error = 100 * np.median(averaging_errors(answer))
    if error < 1:
        return Feedback("right", f"median error {error:.1f} % over five runs")
    if answer < 30:
        return Feedback("look again", f"median error {error:.0f} %: noise still hides the pulse")
    return Feedback("look again", f"median error {error:.0f} %: over that time the pulse moves and smears")


def averaging_errors(frames, snr_db=-20.0, seeds=range(5)):
    """Mean error of the range ratio, one beam of the array, pulse 2-4, for each seed."""
    sea, array, passage = PekerisWaveguide(), HorizontalArray(band=(199.0, 401.0)), Passage()
    modes = solve_modes(sea, array.frequency)
    delay = np.arange(20e-3, 180e-3, 0.5e-3)
    _, distance = bearing_and_range(passage.track, passage.time)
    clean = pressure(modes, distance)
    middle = np.arange(distance.size - frames + 1) + (frames - 1) / 2
    truth = np.interp(middle, np.arange(distance.size), distance)
    errors = []
    for seed in seeds:
        beam = beam_sound(np.random.default_rng(seed), clean, snr_db, array.elements)
        power = running_mean(np.abs(beam) ** 2, frames)
        followed = follow_pulse(power, array.frequency, delay, pulse_delay(sea, 2, 4, distance[0]))
        errors.append(ratio_error(range_ratio(followed, min(30, followed.size)), truth / truth[0]))
    return np.array(errors)
