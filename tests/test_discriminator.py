from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from labsim.discriminator import (
    BasebandObserver,
    Pair,
    TwoSourceObserver,
    WaveformObserver,
    correlogram,
    curve_slope,
    discriminator_curve,
    hydrophone_noise,
    noise_density,
    noise_density_as_printed,
    read_lags,
    sign_filter,
    sinusoidal_curve,
    source_signals,
    two_channel_waveforms,
)
from labsim.passive_ranging import pulled_delay, pulled_delay_phasor

PAIR = Pair()
SCALE = 2 / (np.pi**2 * 1500**2 * 500)


def record(rng, pair, delay, trials, seconds, reach=0.8e-3):
    delay = np.full(round(seconds * pair.sample_rate), delay)
    return correlogram(pair, *two_channel_waveforms(rng, pair, delay, trials), -reach, reach)


def test_sign_filter_is_the_transform_of_its_weight():
    for frequency in (0.0, 700.0, 1500.0, 1800.0):
        sine = quad(lambda u, f=frequency: np.sin(2 * np.pi * f * u), 0, PAIR.cliff)[0]
        assert sign_filter(frequency, 1500.0) == pytest.approx(-2j * sine, abs=1e-12)


@pytest.mark.parametrize("bandwidth", [300.0, 500.0, 1500.0])
def test_curve_is_the_spectrum_times_the_filter(bandwidth):
    pair = Pair(bandwidth=bandwidth, sample_rate=12000.0)
    for error in (-0.4e-3, 30e-6, 0.1e-3):

        def integrand(f, error=error):
            return (1 - np.cos(np.pi * f / 1500)) * np.sin(2 * np.pi * f * error) / (np.pi * f)

        expected = quad(integrand, *pair.band)[0] / bandwidth
        assert discriminator_curve(pair, error) == pytest.approx(expected, rel=1e-9)


def test_slope_is_a_little_below_the_papers_four():
    assert curve_slope(PAIR) == pytest.approx(3.910, abs=5e-4)
    assert discriminator_curve(PAIR, 1e-8) / 1e-8 == pytest.approx(curve_slope(PAIR), rel=1e-6)
    pairs = [replace(PAIR, bandwidth=b, sample_rate=12000.0) for b in (300, 500, 1000, 1500)]
    factors = [curve_slope(pair) / 4 for pair in pairs]
    np.testing.assert_allclose(factors, [0.992, 0.977, 0.913, 0.818], atol=6e-4)


def test_sinusoidal_curve_stays_within_three_percent_of_the_peak():
    error = np.linspace(-PAIR.cliff, PAIR.cliff, 201)
    exact = discriminator_curve(PAIR, error)
    assert np.max(np.abs(sinusoidal_curve(PAIR, error) - exact)) < 0.03 * np.max(exact)


def test_curve_measured_on_waveforms_is_the_exact_one_within_a_percent_of_its_peak():
    # 40 records of 12 s: standard error 0.25 % of the peak at the errors where it is largest.
    pair = replace(PAIR, noise_power=0.1)
    measured = record(np.random.default_rng(51), pair, 30e-6, 40, 12)
    error = np.linspace(-PAIR.cliff, PAIR.cliff, 41)
    curve = read_lags(measured.lags, measured.quadrature.mean(axis=(0, 1)), 30e-6 - error)
    exact = discriminator_curve(pair, error)
    assert np.max(np.abs(curve - exact)) < 0.01 * np.max(exact)


def waveforms(delay, **power):
    return two_channel_waveforms(np.random.default_rng(0), PAIR, delay, **power)


def slow_noise(pair, error, seed):
    """Density of the discriminator's noise below 5 Hz over 40 records of 12 s; standard error 2 %."""
    measured = record(np.random.default_rng(seed), pair, 0.0, 40, 12)
    values = read_lags(measured.lags, measured.quadrature, np.full((40, 3000, 1), -error))[..., 0]
    averages = values.reshape(40, -1, 25).mean(axis=-1)
    return np.var(averages) * 25 * pair.step


CASES = [(0.0, True, 52), (0.1, False, 53), (1.0, False, 54), (1.0, True, 55)]


@pytest.mark.parametrize("ratio, at_peak, seed", CASES)
def test_noise_density_is_the_mended_one_and_not_the_printed_one(ratio, at_peak, seed):
    # Within 5 %; without noise, at the peak, the finite band alone takes 4 % (next test but one).
    pair = replace(PAIR, noise_power=ratio)
    error = pair.peak if at_peak else 0.0
    measured = slow_noise(pair, error, seed)
    assert measured == pytest.approx(noise_density(pair, error), rel=0.07 if ratio == 0 else 0.05)
    if not at_peak:
        assert measured < 0.7 * noise_density_as_printed(pair)


def test_an_aligned_discriminator_without_noise_is_silent():
    pair = replace(PAIR, noise_power=0.0)
    assert noise_density(pair) == 0
    assert slow_noise(pair, 0.0, 56) < 1e-3 * SCALE
    assert noise_density_as_printed(pair) == pytest.approx(2 * SCALE)


@pytest.mark.parametrize("ratio, error", [(0, 1 / 6000), (0.1, 0), (1, 0), (1, 1 / 6000), (10, 0)])
def test_noise_density_against_the_exact_integral_over_the_band(ratio, error):
    def integrand(f):
        spectra = ((1 + ratio) / 1000) ** 2 - 1e-6 * np.cos(4 * np.pi * f * error)
        return 2 * spectra * np.abs(sign_filter(f, 1500.0)) ** 2

    exact = quad(integrand, *PAIR.band)[0]
    assert noise_density(replace(PAIR, noise_power=ratio), error) == pytest.approx(exact, rel=0.045)


def test_correlogram_holds_the_mean_products():
    rng = np.random.default_rng(57)
    y1, y2 = two_channel_waveforms(rng, PAIR, np.zeros(4000), 2)
    made = correlogram(PAIR, y1, y2, -0.001, 0.002)
    column = np.argmin(np.abs(made.lags - 0.001))
    product = y1[1, 3200:3232] * y2[1, 3192:3224]
    assert made.in_phase[1, 100, column] == pytest.approx(product.mean(), rel=1e-12)
    assert made.quadrature.shape == (2, 125, made.lags.size)


def test_a_moving_delay_is_followed():
    # Noise-free, 3 s: what is left of the zero crossing is the delay's motion within a bin.
    pair = replace(PAIR, noise_power=0.0, step=0.5)
    delay = 0.2e-3 + 100e-6 * np.arange(24000) / 8000
    heard = two_channel_waveforms(np.random.default_rng(58), pair, delay)
    made = correlogram(pair, *heard, 0, 1e-3)
    for k, middle in enumerate(np.arange(6) * 0.5 + 0.25):
        at = read_lags(made.lags, made.quadrature[0, k], 0.2e-3 + 100e-6 * middle + np.array([-1e-6, 1e-6]))
        assert at[0] > 0 > at[1]


def test_hydrophones_hear_the_power_they_are_given():
    rng = np.random.default_rng(59)
    power = np.repeat([4.0, 0.0], 20000)
    heard = source_signals(rng, PAIR, np.zeros((3, 40000)), power=power)
    # 2.5 s of a 500 Hz band: 2,500 independent values, standard error 2.8 %.
    assert np.var(heard[0, :, :20000]) == pytest.approx(4.0, rel=0.12)
    assert np.all(heard[0, :, 20000:] == 0)
    noise = hydrophone_noise(rng, replace(PAIR, noise_power=9.0), (2, 40000))
    assert np.var(noise) == pytest.approx(9.0, rel=0.07)
    assert abs(np.corrcoef(noise)[0, 1]) < 0.06


@pytest.mark.parametrize("share, apart", [(0.5, 0.1e-3), (0.2, 0.1e-3), (0.2, 0.23e-3), (0.5, 0.23e-3)])
def test_two_sources_pull_the_zero_to_where_the_phasor_law_says(share, apart):
    # 40 records of 12 s. The law is that of a narrow band; 2.1 % of the distance is the finite band's part.
    rng, pair = np.random.default_rng(60), replace(PAIR, noise_power=0.0)
    samples = np.zeros((2, 24000))
    heard = source_signals(rng, pair, samples, 40, power=1 - share)
    heard += source_signals(rng, pair, samples + [[apart], [0.0]], 40, power=share)
    made = correlogram(pair, heard[:, 0], heard[:, 1], -1e-3, 1e-3)
    lags = np.linspace(0, apart, 400)
    curve = read_lags(made.lags, made.quadrature.mean(axis=(0, 1)), lags)
    zero = lags[np.argmin(np.abs(curve))]
    assert zero == pytest.approx(pulled_delay_phasor(0.0, apart, share, 1500.0), abs=0.03 * apart)
    if share == 0.2 and apart > 0.2e-3:
        assert abs(zero - pulled_delay(0.0, apart, share)) > 0.06 * apart


def test_baseband_observer_has_the_curve_and_the_noise():
    # 200,000 draws: standard error of the mean 0.2 % of its own deviation, of the variance 0.3 %.
    rng = np.random.default_rng(61)
    error = 60e-6
    observer = BasebandObserver(PAIR, np.array([error]), rng.standard_normal((2, 1, 200_000)))
    values, in_phase = observer.error_signal(0, np.zeros(200_000)), observer.in_phase(0, np.zeros(200_000))
    spread = np.sqrt(noise_density(PAIR, error) / PAIR.step)
    assert np.mean(values) == pytest.approx(discriminator_curve(PAIR, error), abs=0.02 * spread + 2e-6)
    assert np.std(values) == pytest.approx(spread, rel=0.01)
    assert np.mean(in_phase) == pytest.approx(np.cos(PAIR.angular_frequency * error), abs=0.01)


def test_in_phase_noise_of_the_baseband_observer_is_that_of_waveforms():
    # 40 records of 12 s: standard error 2 %.
    rng = np.random.default_rng(62)
    made = record(rng, PAIR, 0.0, 40, 12)
    waveform = WaveformObserver(made)
    values = np.array([waveform.in_phase(k, np.zeros(40)) for k in range(3000)])
    averages = values.reshape(-1, 25, 40).mean(axis=1)
    baseband = BasebandObserver(PAIR, np.zeros(1), rng.standard_normal((2, 1, 100_000)))
    expected = np.var(baseband.in_phase(0, np.zeros(100_000))) / 25
    assert np.var(averages) == pytest.approx(expected, rel=0.08)


def test_the_in_phase_reading_needs_noise_of_its_own():
    observer = BasebandObserver(PAIR, np.zeros(5), np.zeros((1, 5, 3)))
    assert np.all(observer.error_signal(0, np.zeros(3)) == 0)
    with pytest.raises(ValueError, match="noise must have 2 rows"):
        observer.in_phase(0, np.zeros(3))


def test_a_silent_false_source_changes_nothing():
    noise = np.random.default_rng(63).standard_normal((2, 5, 8))
    delay, at = np.full(5, 20e-6), np.zeros(8)
    one = BasebandObserver(PAIR, delay, noise)
    two = TwoSourceObserver(PAIR, delay, np.full(5, 1e-3), 0.0, noise)
    np.testing.assert_allclose(two.error_signal(2, at), one.error_signal(2, at), rtol=1e-3, atol=1e-9)
    np.testing.assert_allclose(two.in_phase(2, at), one.in_phase(2, at), rtol=1e-3, atol=1e-6)


def test_two_equal_sources_pull_the_baseband_curve_to_the_middle():
    observer = TwoSourceObserver(PAIR, np.zeros(1), np.full(1, 0.1e-3), 1.0, np.zeros((2, 1, 1)))
    assert observer.error_signal(0, np.array([0.05e-3])) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: Pair(centre_frequency=0.0), "centre_frequency"),
        (lambda: Pair(bandwidth=3000.0), "bandwidth"),
        (lambda: Pair(signal_power=-1.0), "signal_power must not be negative"),
        (lambda: Pair(noise_power=-1.0), "noise_power must not be negative"),
        (lambda: Pair(sample_rate=4000.0), "sample_rate"),
        (lambda: Pair(step=0.00401), "step must be a whole number of samples"),
        (lambda: Pair(signal_power=0.0).noise_ratio, "signal_power must be above 0"),
        (lambda: waveforms(np.zeros((2, 900))), "delays must have shape"),
        (lambda: waveforms(np.zeros(900), power=-1.0), "power must not be negative"),
        (lambda: waveforms(np.zeros(900), power=np.ones(8)), "power must be a number or"),
        (lambda: correlogram(PAIR, np.zeros((1, 90)), np.zeros((1, 80)), 0, 0), "y2 must have shape"),
        (lambda: correlogram(PAIR, np.zeros((1, 20)), np.zeros((1, 20)), 0, 0), "must hold a step"),
        (lambda: BasebandObserver(PAIR, np.zeros(4), np.zeros((2, 5, 3))), "delay must fit"),
        (lambda: BasebandObserver(PAIR, np.zeros(5), np.zeros((2, 5, 3)), power=-np.ones(5)), "power"),
        (lambda: BasebandObserver(PAIR, np.zeros(5), np.zeros((5, 3))), "noise must have shape"),
        (lambda: TwoSourceObserver(PAIR, np.zeros(5), np.zeros(4), 1.0, np.zeros((2, 5, 3))), "false_delay"),
        (lambda: TwoSourceObserver(PAIR, np.zeros(5), np.zeros(5), -1.0, np.zeros((2, 5, 3))), "false_power"),
    ],
)
def test_bad_input_is_refused_in_words(call, words):
    with pytest.raises(ValueError, match=words):
        call()
