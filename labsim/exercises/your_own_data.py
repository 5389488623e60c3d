"""Feedback on the exercises of notebook 10."""

import numpy as np

from labsim.checks import NOT_ANSWERED, Feedback, check_number

TURNED = np.array([1.0, -1.0, -1.0, -1.0])


def path_length(answer, track):
    """Length of the recorded track, m, along it from its first fix to its last."""
    points = track.position(np.linspace(track.start_time, track.end_time, 1001))
    expected = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    straight = np.linalg.norm(points[-1] - points[0])
    mistakes = [(straight, "that is the distance between its ends, as a bird flies; the vessel turned")]
    hint = "the track is read in metres: add up the lengths of many short steps of track.position(time)"
    return check_number(answer, expected, 0.01, hint, mistakes)


def best_depth(answer, distance=200.0):
    """Depth with the least radial error of position at a horizontal distance, m: distance / sqrt(2)."""
    mistakes = [
        (distance, "that halves the angle; put numbers into the formula on both sides of it"),
        (
            distance * np.sqrt(2),
            "you have the ratio the other way round: the sensor lies less deep than the vessel is far",
        ),
    ]
    hint = "minimise 1.5 ln(d² + z²) - ln z: put its derivative by z to zero, or try depths on a grid"
    return check_number(answer, distance / np.sqrt(2), 0.03, hint, mistakes)


def gains_for_outward_velocity(answer):
    """Gains that make a recording whose velocity counts along the sound's travel point at the source."""
    if answer is ... or answer is None:
        return NOT_ANSWERED
    try:
        gains = np.asarray(answer, dtype=float)
    except (TypeError, ValueError):
        gains = np.zeros(0)
    if gains.shape != (4,) or not np.all(np.isfinite(gains)):
        return Feedback("look again", "the answer must be four numbers, one for each channel, pressure first")
    left = gains * TURNED
    if np.all(left == left[0]) and left[0] != 0:
        return Feedback("right")
    if np.all(gains == gains[0]):
        return Feedback(
            "look again",
            "this changes pressure and velocity alike, and their product, the intensity, not at all",
        )
    if not np.all(np.abs(left) == np.abs(left[0])):
        return Feedback("look again", "a sign is wrong in that recording, not a size: every gain is 1 or -1")
    return Feedback("look again", "all three velocities are counted the other way, not one of them")
