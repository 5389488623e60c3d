"""Feedback on the exercises of chapter 03."""

from dataclasses import replace

import numpy as np

from labsim.checks import NOT_ANSWERED, Feedback, check_number
from labsim.metrics import rmse
from labsim.surface_motion import emission_time, line_fit, motion_bound, position
from labsim.vector_sensor import (
    PassingVessel,
    direction_of_arrival,
    expected_error,
    geometry,
    sample_intensity,
    window_centres,
)

GOAL = 0.2
SHARE = 1.3


def speed_with_wrong_depth(answer):
    """Speed read for a vessel of 12 m/s by a sensor at 100 m that is believed to lie at 105 m."""
    mistakes = [
        (12.0, "the depth multiplies every position (eq. 5), so it cannot leave the speed alone"),
        (12.0 / 1.05, "a sensor believed deeper sees every position farther out, not nearer"),
    ]
    return check_number(answer, 12.0 * 1.05, 0.005, "d = z0 tan(alpha): what is multiplied by z0?", mistakes)


def scatter_at_distance(answer):
    """Ratio of the radial errors of position at slant ranges of 500 and 250 m, the noise being the same."""
    mistakes = [
        (
            4.0,
            "r^2 stretches the angle, but the angle itself gets worse too: the sound is weaker there",
        ),
        (0.125, "the other way round: the error at 500 m over that at 250 m"),
        (
            2.0,
            "that is how the amplitude of the sound falls; put it into sigma and sigma into r^2 sigma / z0",
        ),
    ]
    return check_number(answer, 8.0, 0.02, "r^2 sigma / z0, and sigma itself grows with r", mistakes)


def course_of_the_line(answer):
    """RMSE of the course of the paper's line at 40 s, degrees, in the paper's scenario."""
    expected = np.degrees(_course_error(trials=400))
    mistakes = [(np.radians(expected), "this is in radians; give degrees")]
    hint = (
        "the course of the line is arctan(A): take A from line_fit, nearest 40 s, then the RMSE "
        "over trials. The direction of the fitted velocity will not do: a negative step points it backwards"
    )
    return check_number(answer, expected, 0.15, hint, mistakes)


def shortest_window(answer):
    """Shortest centred span, whole seconds, whose weighted fit errs by at most 0.2 m/s at 20 s and 8 dB."""
    if answer is ... or answer is None:
        return NOT_ANSWERED
    checked = check_number(answer, np.round(_finite(answer)), 1e-9, "give a whole number of seconds")
    if not checked.right:
        return checked
    seconds = int(float(answer))
    if seconds == 44:
        return Feedback("look again", "that is the number of windows; give seconds")
    if not 2 <= seconds <= 40:
        return Feedback("look again", "a centred span at 20 s has at least 2 and at most 40 s")
    if _span_error(seconds) > GOAL:
        return Feedback(
            "look again", f"{seconds} s leave {_span_error(seconds):.3f} m/s, more than {GOAL} m/s"
        )
    if _span_error(seconds - 1) <= GOAL:
        return Feedback("look again", f"{seconds} s are enough, but so are fewer")
    return Feedback("right")


def your_fit(fit, trials=300):
    """Feedback on a function fit(points, time) that makes one velocity of each whole record.

    points : (trials, n, 2), m; time : (trials, n), s; it returns (trials, 2), m/s, or ... while unanswered.
    Right if its RMSE over new records is within 30 % of the bound, for the paper's vessel and for another
    one, slower and on another course, so that no constant will do.
    """
    for vessel in (PassingVessel(), replace(PassingVessel(), start=(60.0, 200.0), speed=9.0, heading=-1.9)):
        feedback = _fit_of(vessel, fit, trials)
        if not feedback.right:
            return feedback
    return feedback


def _fit_of(vessel, fit, trials):
    heard, error = _scene(vessel)
    points = _listen(vessel, np.random.default_rng(303), trials)
    velocity = fit(points, emission_time(points, heard.time, vessel.sensor_depth, vessel.sound_speed))
    if velocity is ... or velocity is None:
        return NOT_ANSWERED
    velocity = np.asarray(velocity, dtype=float)
    if velocity.shape != (trials, 2):
        return Feedback(
            "look again",
            f"the velocity must have shape {(trials, 2)}, one for each record, not {velocity.shape}",
        )
    measured = rmse(np.linalg.norm(velocity - vessel.motion.velocity(0.0), axis=-1))
    bound = _bound(vessel, heard, error)[-1]
    ship = f"a vessel of {vessel.speed:g} m/s, course {np.degrees(vessel.heading):.0f}°"
    if measured <= SHARE * bound:
        return Feedback("right", f"{measured:.3f} m/s for {ship}, where the bound is {bound:.3f} m/s")
    return Feedback(
        "look again", f"{measured:.2g} m/s for {ship}: more than {SHARE} times the bound of {bound:.2g} m/s"
    )


def _course_error(trials):
    vessel = PassingVessel()
    slope, _ = line_fit(_listen(vessel, np.random.default_rng(302), trials))
    at = np.argmin(np.abs(window_centres(vessel) - 40.0))
    return rmse(np.arctan(slope[:, at]) - vessel.heading)


def _span_error(seconds):
    vessel = replace(PassingVessel(), snr_db=8.0)
    heard, error = _scene(vessel)
    bound = _bound(vessel, heard, error, span=round(seconds / vessel.window), centred=True)
    return bound[np.argmin(np.abs(heard.time - 20.25))]


def _scene(vessel):
    time = window_centres(vessel)
    return geometry(vessel, time), expected_error(vessel, time)


def _listen(vessel, rng, trials):
    azimuth, angle = direction_of_arrival(sample_intensity(vessel, rng, trials))
    return position(azimuth, angle, vessel.sensor_depth)


def _bound(vessel, heard, error, **span):
    return motion_bound(heard.position, heard.emitted, vessel.sensor_depth, error, **span)[1]


def _finite(answer):
    try:
        return float(answer) if np.isfinite(float(answer)) else 0.0
    except (TypeError, ValueError):
        return 0.0
