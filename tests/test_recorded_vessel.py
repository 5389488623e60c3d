"""The sample of a recording is what its script makes, and points at the vessel it was made from."""

import runpy

import numpy as np
import pytest
from conftest import ROOT
from scipy.io import wavfile

from labsim.metrics import angle_difference, rmse
from labsim.vector_sensor import (
    averaged_intensity,
    direction_of_arrival,
    expected_error,
    geometry,
    load_recording,
    window_centres,
)

DATA = ROOT / "notebooks" / "data"
FILE = DATA / "recorded_vessel.wav"
SAMPLES = runpy.run_path(str(DATA / "make_recording.py"))
VESSEL = SAMPLES["VESSEL"]


def directions(order="pxyz"):
    heard = load_recording(FILE, order)
    return direction_of_arrival(averaged_intensity(heard.pressure, heard.velocity, VESSEL.samples_per_window))


def test_the_sample_is_what_its_script_makes():
    # another numpy may round a sample that lies between two integers the other way
    rate, kept = wavfile.read(FILE)
    assert rate == VESSEL.sample_rate and kept.dtype == np.int16
    assert np.abs(kept.astype(int) - SAMPLES["channels"]()).max() <= 1


def test_the_sample_is_small():
    assert FILE.stat().st_size < 150_000


def test_directions_err_as_much_as_the_law_of_chapter_02_says():
    # 16 windows and two angles: the mean square of 32 normalised errors is 1 within 3.5 sqrt(2 / 32)
    time = window_centres(VESSEL)
    truth = geometry(VESSEL, time)
    azimuth, angle = directions()
    across = angle_difference(azimuth, truth.azimuth) * np.sin(truth.angle_from_vertical)
    errors = np.stack([across, angle - truth.angle_from_vertical])
    expected = expected_error(VESSEL, time)
    assert rmse(errors / expected, axis=None) ** 2 == pytest.approx(1, abs=3.5 * np.sqrt(2 / errors.size))


def test_the_wrong_channel_order_points_elsewhere():
    right, wrong = directions()[0], directions("sn3d")[0]
    assert np.degrees(rmse(angle_difference(wrong, right))) > 30
