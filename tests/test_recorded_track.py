"""The sample of a recorded track is what its script makes, and reads as the path it was made from."""

import runpy

import numpy as np
import pytest
from conftest import ROOT

from labsim.motion import load_track

DATA = ROOT / "notebooks" / "data"
SAMPLES = runpy.run_path(str(DATA / "make_samples.py"))


def test_the_sample_is_what_its_script_makes_and_says_that_it_is_synthetic():
    kept = (DATA / "recorded_track.csv").read_text(encoding="utf-8").splitlines()
    assert kept == SAMPLES["lines"]()
    assert all(line.endswith(",synthetic") for line in kept[1:])


def test_the_sample_reads_as_the_path_it_was_made_from():
    track = load_track(DATA / "recorded_track.csv", origin=SAMPLES["SENSOR"])
    # 25 fixes with 50 errors: their root mean square is known to 10 %, and three of these are allowed.
    time = np.arange(0.0, 121.0, 5.0)
    miss = track.position(time) - SAMPLES["sailed"]().position(time)
    assert np.sqrt(np.mean(miss**2)) == pytest.approx(SAMPLES["FIX_ERROR"], rel=0.3)
