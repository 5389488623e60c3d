"""The Kalman tracker's motion model, from what any motion model must satisfy."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from labsim.delay_tracking import KalmanTracker


@given(interval=st.floats(0.01, 2.0), agility=st.floats(1e-12, 1e-8))
def test_two_steps_scatter_a_track_as_one_of_twice_the_length(interval, agility):
    tracker = KalmanTracker(interval, agility)
    double = replace(tracker, interval=2 * interval)
    move, push = tracker.transition, tracker.process_noise
    np.testing.assert_allclose(move @ move, double.transition)
    np.testing.assert_allclose(move @ push @ move.T + push, double.process_noise)
