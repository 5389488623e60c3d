import numpy as np
import pytest

from labsim.noise import band_noise, decibels, power_ratio, sample_at

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


def test_decibels_and_power_ratios_undo_each_other():
    assert decibels(100.0) == pytest.approx(20.0)
    np.testing.assert_allclose(power_ratio(decibels(np.array([0.1, 3.0]))), [0.1, 3.0])


def test_band_noise_has_unit_power_all_of_it_in_its_band():
    # 2 B T = 1600 degrees of freedom in each of 100 records: the mean power is known to 0.35 %.
    noise = band_noise(np.random.default_rng(4), (100, 8000), (500, 1300), RATE)
    assert np.mean(noise**2) == pytest.approx(1.0, rel=0.011)
    power = np.mean(np.abs(np.fft.rfft(noise)) ** 2, axis=0)
    frequency = np.fft.rfftfreq(8000, 1 / RATE)
    inside = (frequency >= 500) & (frequency <= 1300)
    assert np.max(power[~inside]) < 1e-20 * np.mean(power[inside])
    halves = np.mean(power[inside].reshape(-1)[:400]), np.mean(power[inside][-400:])
    assert halves[0] == pytest.approx(halves[1], rel=0.03)


@pytest.mark.parametrize("band", [(300, 200), (-1, 200), (200, 4001), (200, 200), (200, np.nan)])
def test_a_band_that_is_reversed_or_beyond_half_the_sample_rate_is_refused(band):
    with pytest.raises(ValueError, match="band must be"):
        band_noise(np.random.default_rng(0), 100, band, RATE)


def test_a_band_between_two_frequency_bins_is_refused():
    with pytest.raises(ValueError, match="band must be wider than 80 Hz"):
        band_noise(np.random.default_rng(0), 100, (81, 159), RATE)
