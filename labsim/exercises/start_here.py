"""Feedback on the exercise of the start notebook."""

import numpy as np

from labsim.checks import check_number
from labsim.motion import straight_track


def closest_time(answer):
    """Time of closest approach of the start notebook's vessel, s."""
    track = straight_track(start=(-250, 100), speed=12, heading=np.radians(10))
    start, velocity = track.position(0), track.velocity(0)
    expected = -start @ velocity / (velocity @ velocity)
    return check_number(
        answer, expected, 0.05, "move the slider until the distance is smallest, and read the time"
    )
