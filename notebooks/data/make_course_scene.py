"""Make course_scene.npz: what a 64-element array hears of two vessels, for notebook 06.

Two passages of 20 minutes (constant speed, and accelerating), 1,172 frames x 64 receivers x 410 frequencies
each, at -15 dB a receiver, are beamformed; kept are the MVDR bearing record, the bearing of every frame, and
the power spectrum of the beam that follows the vessel, averaged over 16 frames, every fourth row, 200-400 Hz.
Run it from the repository: python notebooks/data/make_course_scene.py. It takes about 15 seconds and 500 MB.
"""

from pathlib import Path

import numpy as np

from labsim.beamforming import bearing_track, block_to_frames, mean_phase_speed, mvdr_record, steer
from labsim.course import Passage, bearing_and_range
from labsim.noise import power_ratio
from labsim.warping import BAND, running_mean
from labsim.waveguide import HorizontalArray, PekerisWaveguide, array_field, pressure, ship_sound, solve_modes

FILE = Path(__file__).with_name("course_scene.npz")
PASSAGES = {"uniform": Passage(), "accelerating": Passage(acceleration=0.01)}
SEED = 20
SNR_DB = -15.0
BLOCK, AVERAGE, KEEP = 12, 16, 4
LOOK = np.radians(np.arange(50.0, 125.1, 0.5))


def hear(passage, seed=SEED, frames=None):
    """Bearing record (blocks, beams), bearings (frames,), and averaged beam spectra (rows, bins).

    frames : only the first so many of the passage, or None for all
    """
    sea, array = PekerisWaveguide(), HorizontalArray()
    modes = solve_modes(sea, array.frequency)
    bearing, distance = bearing_and_range(passage.track, passage.time)
    noise_power = np.mean(np.abs(pressure(modes, distance)) ** 2) * power_ratio(-SNR_DB)
    phase_speed = mean_phase_speed(modes, 3.0, array.depth, distance[0])
    field = array_field(modes, array, distance[:frames], bearing[:frames])
    ship_sound(np.random.default_rng(seed), field, noise_power)
    record = mvdr_record(field, array, LOOK, phase_speed, BLOCK)
    found = block_to_frames(bearing_track(record, LOOK), BLOCK, field.shape[0])
    beam = np.abs(steer(field, array, found, phase_speed)) ** 2
    return record, found, running_mean(beam, AVERAGE)[::KEEP, in_band(array.frequency)]


def in_band(frequency):
    """The bins that warping needs: the band and one bin on either side."""
    return (frequency > BAND[0] - 1) & (frequency < BAND[1] + 1)


def compact(record, found, spectrum):
    """The results as small types: decibels below the peak in steps of 0.25, and half precision."""
    level = np.rint(np.clip(-40 * np.log10(record / record.max()), 0, 255))
    return {
        "record": level.astype(np.uint8),
        "bearing": found.astype(np.float32),
        "spectrum": (spectrum / spectrum.mean()).astype(np.float16),
    }


def main():
    frequency = HorizontalArray().frequency
    arrays = {"look": LOOK, "frequency": frequency[in_band(frequency)]}
    for name, passage in PASSAGES.items():
        rows = passage.time[: passage.time.size - AVERAGE + 1 : KEEP]
        arrays["time"] = rows + (AVERAGE - 1) / 2 * passage.frame
        arrays |= {f"{name}_{part}": value for part, value in compact(*hear(passage)).items()}
    np.savez_compressed(FILE, **arrays)


if __name__ == "__main__":
    main()
