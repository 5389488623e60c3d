"""Make recorded_vessel.wav, a SYNTHETIC sample of a vector sensor's recording, for notebook 10.

No vessel made this noise. It is laid out like a recording so that notebook 10 can show how to read one of
your own: four channels (pressure, then particle velocity times rho c along x, y and z), 16 bits, 4000
samples a second, four seconds. VESSEL passes while it lasts.
Run it from the repository: python notebooks/data/make_recording.py.
"""

from pathlib import Path

import numpy as np
from scipy.io import wavfile

from labsim.motion import passing_start
from labsim.vector_sensor import PassingVessel, record

FILE = Path(__file__).with_name("recorded_vessel.wav")
SEED = 10
HEADING = np.radians(30.0)
VESSEL = PassingVessel(
    sensor_depth=30.0,
    start=passing_start(distance=25.0, time=2.2, speed=10.0, heading=HEADING),
    speed=10.0,
    heading=HEADING,
    sample_rate=4000.0,
    duration=4.0,
    window=0.25,
    snr_db=14.0,
)


def channels():
    """The four channels, (n, 4) of 16-bit integers, the largest at nine tenths of full scale."""
    heard = record(VESSEL, np.random.default_rng(SEED))
    waves = np.column_stack([heard.pressure, heard.velocity])
    return np.round(waves * (0.9 * 32767 / np.abs(waves).max())).astype(np.int16)


if __name__ == "__main__":
    wavfile.write(FILE, int(VESSEL.sample_rate), channels())
