"""Make recorded_track.csv, a SYNTHETIC sample of a GPS track, for notebook 03.

No vessel sailed it. It is laid out like a recorded track so that notebook 03 can show how to read one of
your own: times and degrees, one fix every 5 seconds for two minutes, each wrong by about 0.3 m, as after
differential correction. A vessel of 6 m/s passes 60 m from the point SENSOR and turns by 80 degrees.
Run it from the repository: python notebooks/data/make_samples.py.
"""

from pathlib import Path

import numpy as np

from labsim.motion import EARTH_RADIUS, course_track, passing_start

FILE = Path(__file__).with_name("recorded_track.csv")
SENSOR = (60.25, 5.12)
SEED = 3
FIX_ERROR = 0.3


def sailed():
    """The path without the errors of the fixes: metres from SENSOR."""
    heading = np.radians(20.0)
    start = passing_start(60.0, 35.0, 6.0, heading)
    turn = heading + np.radians([0.0, 0.0, 80.0, 80.0])
    return course_track(start, 6.0, [0.0, 45.0, 80.0, 120.0], turn)


def lines():
    """The lines of the file."""
    time = np.arange(0, 121, 5)
    fixes = sailed().position(time) + np.random.default_rng(SEED).normal(scale=FIX_ERROR, size=(time.size, 2))
    east, north = np.degrees(fixes / EARTH_RADIUS).T
    latitude, longitude = SENSOR[0] + north, SENSOR[1] + east / np.cos(np.radians(SENSOR[0]))
    rows = (
        f"2026-05-04T09:{t // 60:02d}:{t % 60:02d}Z,{a:.7f},{o:.7f},synthetic"
        for t, a, o in zip(time, latitude, longitude, strict=True)
    )
    return ["time,latitude,longitude,note", *rows]


if __name__ == "__main__":
    FILE.write_text("\n".join(lines()) + "\n", encoding="utf-8", newline="\n")
