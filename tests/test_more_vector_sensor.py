"""How the loudness of a recorded passage follows the distance."""

import numpy as np
import pytest

from labsim.vector_sensor import PassingVessel, closest_approach, geometry, record, window_centres


@pytest.mark.parametrize("channel", ["pressure", "velocity"])
def test_recorded_power_falls_with_the_square_of_the_distance(channel):
    # Seed 31, one record of 120 windows with B T = 300 each and noise 60 dB down: the power in a window
    # scatters by 1/sqrt(B T), and the mean over the windows by 1/sqrt(120 B T); five of each are allowed.
    vessel = PassingVessel(snr_db=60.0)
    wave = getattr(record(vessel, np.random.default_rng(31)), channel)
    power = (wave.reshape(vessel.samples, -1) ** 2).sum(axis=1).reshape(vessel.windows, -1).mean(axis=1)
    distance = geometry(vessel, window_centres(vessel)).slant_range
    relative = power / (closest_approach(vessel).slant_range / distance) ** 2
    assert distance.max() > 2 * distance.min()
    assert np.mean(relative) == pytest.approx(1, abs=5 / np.sqrt(120 * vessel.time_bandwidth))
    assert np.max(np.abs(relative - 1)) < 5 / np.sqrt(vessel.time_bandwidth)
