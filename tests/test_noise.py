import numpy as np
import pytest

from labsim.noise import band_noise, sample_at

RATE = 8000.0


ERRORS_DB = [(0.0, -85), (400.0, -85), (1750.0, -85), (2000.0, -85), (2160.0, -60)]


@pytest.mark.parametrize("frequency, error_db", ERRORS_DB)
def test_reading_a_sinusoid_between_its_samples(frequency, error_db):
    time = np.random.default_rng(1).uniform(0.01, 0.48, 5000)
    read = sample_at(np.cos(2 * np.pi * frequency * np.arange(4000) / RATE), RATE, time)
    assert 20 * np.log10(np.max(np.abs(read - np.cos(2 * np.pi * frequency * time)))) < error_db


def test_reading_at_the_samples_returns_them():
    signal = band_noise(np.random.default_rng(2), 1000, (1000, 2000), RATE)
    index = np.arange(10, 990)
    np.testing.assert_allclose(sample_at(signal, RATE, index / RATE), signal[index], atol=1e-9)


def test_a_batch_of_signals_is_read_row_by_row():
    rng = np.random.default_rng(3)
    signals = band_noise(rng, (2, 3, 500), (1000, 2000), RATE)
    time = rng.uniform(0.01, 0.05, (2, 3, 40))
    batch = sample_at(signals, RATE, time)
    assert batch.shape == (2, 3, 40)
    for i, j in np.ndindex(2, 3):
        np.testing.assert_array_equal(batch[i, j], sample_at(signals[i, j], RATE, time[i, j]))


def test_one_signal_is_read_at_times_of_any_shape():
    signal = np.arange(20.0)
    assert sample_at(signal, 1.0, 7.0) == pytest.approx(7.0)
    assert sample_at(signal, 1.0, np.full((2, 3), 8.0)).shape == (2, 3)


def test_reading_outside_the_signal_or_with_other_trials_is_refused():
    with pytest.raises(ValueError, match="time must lie between"):
        sample_at(np.zeros(100), RATE, 0.0)
    with pytest.raises(ValueError, match="time must have shape"):
        sample_at(np.zeros((2, 100)), RATE, np.full((3, 5), 0.006))
