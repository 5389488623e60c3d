from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from labsim import delay_tracking as dt
from labsim.delay_tracking import KalmanTracker, Loop
from labsim.discriminator import (
    BasebandObserver,
    Pair,
    TwoSourceObserver,
    WaveformObserver,
    correlogram,
    curve_slope,
    two_channel_waveforms,
)

PAIR = Pair()
SHARE_OF_SLOPE = curve_slope(PAIR) / 4


def from_waveforms(rng, pair, delay, trials, power=1.0, room=0.8e-3):
    y1, y2 = two_channel_waveforms(rng, pair, delay, trials, power)
    return WaveformObserver(correlogram(pair, y1, y2, np.min(delay) - room, np.max(delay) + room))


def at_baseband(rng, pair, delay, trials, power=1.0):
    return BasebandObserver(pair, delay, rng.standard_normal((2, len(delay), trials)), power)


def steps(seconds):
    return (np.arange(round(seconds / PAIR.step)) + 0.5) * PAIR.step


def samples(seconds):
    return np.arange(round(seconds * PAIR.sample_rate)) / PAIR.sample_rate


def manoeuvre(time):
    """67, then -67, then 30 us/s, four seconds each."""
    return 1e-6 * np.interp(time, [0, 4, 8, 12], [0, 268, 0, 120])


def rms(error):
    return np.sqrt(np.mean(np.square(error)))


def test_mended_constant_is_the_cramer_rao_bound_of_twice_the_time_constant():
    for ratio in (0.01, 1.0, 10.0):
        pair = replace(PAIR, noise_power=ratio)
        coherence = 1 / (1 + ratio) ** 2
        band = np.linspace(*pair.band, 20001)
        information = 2 * np.mean((2 * np.pi * band) ** 2) * 500 * coherence / (1 - coherence)
        bound = 1 / (information * 2 * 0.3)
        assert dt.loop_constant(pair) / 0.3 == pytest.approx(bound, rel=0.01)


def test_printed_constant_does_not_vanish_without_noise():
    quiet = replace(PAIR, noise_power=0.0)
    assert dt.loop_constant(quiet) == 0
    assert dt.loop_constant_as_printed(quiet) == pytest.approx(2 / (16 * np.pi**2 * 1500**2 * 500))


JITTER_CASES = [(0.1, 0.05, 8, 71), (0.1, 0.5, 20, 72), (1.0, 0.2, 20, 73), (4.0, 0.2, 20, 74)]


@pytest.mark.parametrize("ratio, time_constant, seconds, seed", JITTER_CASES)
def test_jitter_of_the_loop_on_waveforms_and_at_baseband(ratio, time_constant, seconds, seed):
    # 48 records hold 24 seconds / T independent values: standard error 2.3 to 4.6 % of the variance.
    rng, pair = np.random.default_rng(seed), replace(PAIR, noise_power=ratio)
    settled = round(6 * time_constant / pair.step)
    waveform = dt.track(from_waveforms(rng, pair, np.zeros(8000 * seconds), 48), pair, Loop(time_constant))[
        settled:
    ]
    baseband = dt.track(at_baseband(rng, pair, np.zeros(5000), 300), pair, Loop(time_constant))[settled:]
    constant = dt.loop_constant(pair)
    assert 0.93 < np.var(waveform) * time_constant / constant < 1.08
    assert rms(waveform) / rms(baseband) == pytest.approx(1, abs=0.08)
    turning_in_steps = dt.delay_jitter(constant, time_constant - pair.step / 2)
    assert rms(baseband) == pytest.approx(turning_in_steps, rel=0.03)
    if ratio < 1:
        assert np.var(waveform) * time_constant < 0.2 * dt.loop_constant_as_printed(pair)


@pytest.mark.parametrize("jump", [20e-6, 80e-6, 150e-6])
def test_response_to_a_jump(jump):
    # 400 trials: standard error below 0.4 us in e(T); the theory takes the sine's slope for the true one.
    rng, pair = np.random.default_rng(75), replace(PAIR, noise_power=0.1)
    estimate = dt.track(at_baseband(rng, pair, np.full(151, jump), 400), pair, Loop(0.3))
    left = jump - np.mean(estimate[75])
    assert left / dt.step_response(pair, jump, 0.3 / SHARE_OF_SLOPE, 0.3) == pytest.approx(1, abs=0.025)


def test_jump_response_of_waveforms():
    # 64 records: the jitter of 6 us leaves a standard error of 0.4 us, one per cent of what is left.
    rng, pair = np.random.default_rng(76), replace(PAIR, noise_power=0.1)
    estimate = dt.track(from_waveforms(rng, pair, np.full(12_000, 80e-6), 64), pair, Loop(0.3))
    left = 80e-6 - np.mean(estimate[75])
    assert left / dt.step_response(pair, 80e-6, 0.3 / SHARE_OF_SLOPE, 0.3) == pytest.approx(1, abs=0.04)


@pytest.mark.parametrize("rate, time_constant", [(67e-6, 0.9), (200e-6, 0.3), (200e-6, 0.45)])
def test_lag_behind_a_ramp(rate, time_constant):
    # 32 records: standard error 0.5 to 0.8 % of the lag, measured over their second halves.
    rng, pair = np.random.default_rng(77), replace(PAIR, noise_power=0.1)
    seconds = 12 * time_constant
    sine = pair.angular_frequency * dt.ramp_lag(rate, time_constant / SHARE_OF_SLOPE)
    expected = np.arcsin(sine) / pair.angular_frequency
    waveform = dt.track(from_waveforms(rng, pair, rate * samples(seconds), 32), pair, Loop(time_constant))
    truth = rate * steps(seconds)[: len(waveform), None]
    half = len(truth) // 2
    assert np.mean((truth - waveform)[half:]) / expected == pytest.approx(1, abs=0.04)
    baseband = dt.track(at_baseband(rng, pair, truth[:, 0], 300), pair, Loop(time_constant))
    assert np.mean((truth - baseband)[half:]) / expected == pytest.approx(1, abs=0.01)


def test_lag_is_rate_times_time_constant_where_it_is_small():
    rng, pair = np.random.default_rng(78), replace(PAIR, noise_power=0.1)
    ramp = 30e-6 * steps(6)
    error = ramp[:, None] - dt.track(at_baseband(rng, pair, ramp, 400), pair, Loop(0.3))
    assert np.mean(error[750:]) == pytest.approx(dt.ramp_lag(30e-6, 0.3), rel=0.04)


def test_the_optimum_is_the_minimum_and_splits_one_to_two():
    constant, rate = dt.loop_constant(PAIR), 67e-6
    found = minimize_scalar(lambda t: dt.total_error(constant, t, rate), bounds=(0.01, 3), method="bounded",
                            options={"xatol": 1e-9})  # fmt: skip
    best = dt.best_time_constant(constant, rate)
    assert best == pytest.approx(found.x, rel=1e-5)
    assert best == pytest.approx(0.204, abs=5e-4)
    assert dt.least_total_error(constant, rate) == pytest.approx(found.fun, rel=1e-9)
    assert dt.ramp_lag(rate, best) / found.fun == pytest.approx(1 / 3, rel=1e-9)
    assert dt.best_time_constant(constant, 0.0) == np.inf


@given(st.floats(1e-6, 1e-3), st.floats(1.1, 50.0))
def test_a_faster_target_costs_the_cube_root_of_its_speed(rate, factor):
    constant = dt.loop_constant(PAIR)
    ratio = dt.least_total_error(constant, factor * rate) / dt.least_total_error(constant, rate)
    assert ratio == pytest.approx(np.cbrt(factor))


@pytest.mark.parametrize("ratio", [1.0, 3.0])
@pytest.mark.parametrize("factor", [0.7, 1.0, 1.4])
def test_total_error_near_its_optimum(ratio, factor):
    # 200 records of 8 s: standard errors 0.8 % (sigma) and 0.5 % (lag).
    rng, pair = np.random.default_rng(79), replace(PAIR, noise_power=ratio)
    constant = dt.loop_constant(pair)
    time_constant = factor * dt.best_time_constant(constant, 67e-6)
    ramp = 67e-6 * steps(12)
    error = (ramp[:, None] - dt.track(at_baseband(rng, pair, ramp, 200), pair, Loop(time_constant)))[1000:]
    measured = np.mean(error) + 3 * np.std(error)
    assert measured == pytest.approx(dt.total_error(constant, time_constant, 67e-6), rel=0.06)


def test_total_error_of_waveforms_at_the_optimum():
    # 40 records of 8 s: standard error 1.6 % of sigma, two thirds of the total.
    rng = np.random.default_rng(80)
    constant = dt.loop_constant(PAIR)
    time_constant = dt.best_time_constant(constant, 67e-6)
    estimate = dt.track(from_waveforms(rng, PAIR, 67e-6 * samples(12), 40), PAIR, Loop(time_constant))
    error = (67e-6 * steps(12)[:, None] - estimate)[1000:]
    measured = np.mean(error) + 3 * np.std(error)
    assert measured == pytest.approx(dt.least_total_error(constant, 67e-6), rel=0.06)


def test_a_batch_runs_each_trial_as_if_alone():
    rng = np.random.default_rng(81)
    noise, truth = rng.standard_normal((2, 300, 4)), manoeuvre(steps(1.2))
    batch = BasebandObserver(PAIR, truth, noise)
    loop = Loop(0.2, memory=0.8)
    for run in (dt.track, dt.track_with_gain_control):
        together = run(batch, PAIR, loop)
        for trial in range(4):
            alone = run(BasebandObserver(PAIR, truth, noise[:, :, trial : trial + 1]), PAIR, loop)
            np.testing.assert_allclose(together[:, trial], alone[:, 0], rtol=1e-12)


def test_a_loop_with_memory_follows_a_ramp_without_lag():
    # 200 trials over the last 4 s: standard error 0.1 us; the simple loop lags by 20 us.
    ramp = 67e-6 * steps(10)
    observer = at_baseband(np.random.default_rng(82), PAIR, ramp, 200)
    remembering = dt.track(observer, PAIR, Loop(0.3, memory=1.2))
    assert np.mean((ramp[:, None] - remembering)[1500:]) == pytest.approx(0, abs=0.5e-6)


def test_aiding_by_a_gyro_removes_the_lag_of_a_turn():
    # The array turns by 0.04 degrees a second at a delay of 10 ms: 22 us/s.
    turn = np.radians(0.04)
    rate = dt.gyro_rate(50.0, 0.010, turn)
    truth = rate * steps(6)
    observer = at_baseband(np.random.default_rng(83), replace(PAIR, noise_power=0.1), truth, 200)
    unaided, aided = (dt.track(observer, PAIR, Loop(0.5), aiding=a) for a in (0.0, rate))
    assert np.mean((truth[:, None] - aided)[750:]) == pytest.approx(0, abs=0.3e-6)
    assert np.mean((truth[:, None] - unaided)[750:]) == pytest.approx(rate * 0.5, rel=0.05)


def test_gyro_rate_is_the_derivative_of_the_delay():
    bearing, turn, small = np.radians(25.0), 0.01, 1e-6
    before, after = (50.0 / 1500 * np.sin(bearing - turn * t) for t in (-small, small))
    expected = dt.gyro_rate(50.0, 50.0 / 1500 * np.sin(bearing), turn)
    assert expected == pytest.approx((after - before) / (2 * small), rel=1e-6)


def kalman_errors(observer, pair, tracker, truth, burn=10):
    state = dt.track_kalman(observer, pair, tracker)
    ends = (np.arange(len(state)) + 1) * tracker.interval
    return (state[..., 0] - truth(ends)[:, None])[burn:]


def test_kalman_tracker_on_waveforms_and_at_baseband():
    # 100 records on waveforms, 400 at baseband: standard errors 1.2 % and 0.6 % of the rms.
    rng, tracker = np.random.default_rng(84), KalmanTracker(intensity=2e-9)
    waveform = kalman_errors(from_waveforms(rng, PAIR, manoeuvre(samples(12)), 100), PAIR, tracker, manoeuvre)
    baseband = kalman_errors(at_baseband(rng, PAIR, manoeuvre(steps(12)), 400), PAIR, tracker, manoeuvre)
    assert rms(waveform) / rms(baseband) == pytest.approx(1, abs=0.03)


@given(interval=st.floats(0.01, 2.0), intensity=st.floats(1e-12, 1e-8))
def test_two_steps_scatter_a_track_as_one_of_twice_the_length(interval, intensity):
    tracker = KalmanTracker(interval, intensity)
    double = replace(tracker, interval=2 * interval)
    move, push = tracker.transition, tracker.process_noise
    np.testing.assert_allclose(move @ move, double.transition)
    np.testing.assert_allclose(move @ push @ move.T + push, double.process_noise)


def test_a_tracker_that_starts_on_a_ramp_sees_what_it_sees_at_rest():
    rng, start, rate = np.random.default_rng(92), 2e-3, 40e-6
    rest = at_baseband(rng, PAIR, np.zeros(400), 5)
    moving = replace(rest, delay=start + rate * steps(1.6))
    state = dt.track_kalman(moving, PAIR, KalmanTracker(), start, rate)
    ends = 0.1 * np.arange(1, 17)
    np.testing.assert_allclose(
        state - np.stack([start + rate * ends, np.full(16, rate)], axis=-1)[:, None],
        dt.track_kalman(rest, PAIR, KalmanTracker()), atol=1e-12,
    )  # fmt: skip


def drawn_from_the_model(rng, tracker, intervals, trials, start):
    """Delays in the middle of every step and states at the end of every interval, as the filter assumes."""
    step = KalmanTracker(PAIR.step, tracker.intensity)
    root = np.linalg.cholesky(step.process_noise)
    per_interval = round(tracker.interval / PAIR.step)
    state = np.linalg.cholesky(start) @ rng.standard_normal((2, trials))
    middle, ends = [], []
    for k in range(intervals * per_interval):
        middle.append(state[0] + state[1] * PAIR.step / 2)
        state = step.transition @ state + root @ rng.standard_normal((2, trials))
        if (k + 1) % per_interval == 0:
            ends.append(state.T)
    return np.array(middle), np.array(ends)


@pytest.mark.parametrize("ratio", [0.3, 1.0])
def test_scalar_kalman_tracker_knows_its_own_error(ratio):
    # 600 tracks of 80 intervals, correlated over about 5: standard error 1.4 %.
    rng, pair = np.random.default_rng(85), replace(PAIR, noise_power=ratio)
    start = np.diag([10e-6, 50e-6]) ** 2
    tracker = KalmanTracker(intensity=1e-9)
    middle, ends = drawn_from_the_model(rng, tracker, 80, 600, start)
    state = dt.track_kalman(at_baseband(rng, pair, middle, 600), pair, tracker, covariance=start)
    _, covariance = dt.kalman_gains(pair, tracker, 80, start)
    error = state - ends
    squared = np.einsum("kti,kij,ktj->kt", error, np.linalg.inv(covariance), error)
    assert 0.93 < np.mean(squared) / 2 < 1.07
    assert 0.93 < np.mean(error[..., 0] ** 2 / covariance[:, None, 0, 0]) < 1.07


def test_papers_filter_told_the_truth_about_its_noise_diverges():
    rng = np.random.default_rng(86)
    observer = at_baseband(rng, PAIR, manoeuvre(steps(12)), 100)
    trackers = [KalmanTracker(intensity=2e-9, form=form) for form in dt.FORMS]
    scalar, diagonal, rank_one = (rms(kalman_errors(observer, PAIR, t, manoeuvre)) for t in trackers)
    assert diagonal == pytest.approx(scalar, rel=0.1)
    assert rank_one > 3 * scalar


def test_paper_form_believes_more_than_it_knows():
    # The same 600 tracks as above: standard error 1.4 %.
    rng = np.random.default_rng(87)
    start = np.diag([10e-6, 50e-6]) ** 2
    tracker = KalmanTracker(intensity=1e-9, form="diagonal")
    middle, ends = drawn_from_the_model(rng, tracker, 80, 600, start)
    state = dt.track_kalman(at_baseband(rng, PAIR, middle, 600), PAIR, tracker, covariance=start)
    _, covariance = dt.kalman_gains(PAIR, tracker, 80, start)
    assert np.mean((state - ends)[..., 0] ** 2 / covariance[:, None, 0, 0]) > 1.07


def test_kalman_without_intensity_needs_less_and_less_input():
    gains, covariance = dt.kalman_gains(PAIR, KalmanTracker(intensity=0.0), 400)
    assert np.all(np.diff(gains[5:, 0, 0]) < 0) and gains[-1, 0, 0] < 0.02
    assert np.all(np.linalg.eigvalsh(covariance) > 0)


def after_a_fade(rng, run, rate, length, trials, waveforms=False, seconds_after=8.0):
    """Share of loops lost after a fade of `length` times the paper's longest, the rate unknown during it."""
    fade = length * dt.maximum_fade(PAIR, rate)
    time = samples(1 + fade + seconds_after) if waveforms else steps(1 + fade + seconds_after)
    truth = rate * np.clip(time - 1, 0, fade)
    power = np.where((time >= 1) & (time < 1 + fade), 0.0, 1.0)
    observe = from_waveforms if waveforms else at_baseband
    estimate = run(observe(rng, PAIR, truth, trials, power), PAIR, Loop(0.3, memory=1.2))
    return np.mean(dt.lost(PAIR, estimate[-1] - truth[-1]))


@pytest.mark.parametrize("rate", [100e-6, 200e-6])
def test_half_the_loops_survive_twice_the_papers_fade(rate):
    # 800 trials: standard error 1.8 % of each share, 0.02 of the crossing.
    rng = np.random.default_rng(88)
    lengths = np.array([1.8, 1.9, 2.0, 2.1, 2.2])
    shares = [after_a_fade(rng, dt.track, rate, n, 800) for n in lengths]
    assert 1.9 < np.interp(0.5, shares, lengths) < 2.1


@pytest.mark.parametrize("rate", [100e-6, 200e-6])
def test_gain_control_brings_the_limit_back_to_the_papers(rate):
    rng = np.random.default_rng(89)
    lengths = np.array([0.9, 1.0, 1.1, 1.2, 1.3, 1.4])
    shares = [after_a_fade(rng, dt.track_with_gain_control, rate, n, 800) for n in lengths]
    assert 1.0 < np.interp(0.5, shares, lengths) < 1.3


@pytest.mark.parametrize("run, length", [(dt.track, 1.8), (dt.track_with_gain_control, 1.6)])
def test_loss_after_a_fade_on_waveforms_and_at_baseband(run, length):
    # 100 records against 1,000: standard error 4 % of the share, less than half the tolerance.
    rng = np.random.default_rng(90)
    waveform = after_a_fade(rng, run, 200e-6, length, 100, waveforms=True, seconds_after=5.0)
    baseband = after_a_fade(rng, run, 200e-6, length, 1000, seconds_after=5.0)
    assert waveform == pytest.approx(baseband, abs=0.1)


def test_longest_fade_by_the_papers_formula_and_exactly():
    assert dt.maximum_fade(PAIR, 50e-6) == pytest.approx(3.333, abs=1e-3)
    assert dt.maximum_fade_exactly(PAIR, 50e-6) == pytest.approx(dt.maximum_fade(PAIR, 50e-6))
    rate, acceleration = 100e-6, np.array([-10e-6, 10e-6, 27e-6])
    time = dt.maximum_fade_exactly(PAIR, rate, acceleration)
    np.testing.assert_allclose(rate * time + acceleration * time**2 / 2, PAIR.peak, rtol=1e-12)
    shortfall = 1 - dt.maximum_fade(PAIR, rate, acceleration[1:]) / time[1:]
    assert np.all((shortfall > 0) & (shortfall < 0.09))


def test_a_target_that_turns_back_is_lost_on_the_other_side():
    time = dt.maximum_fade_exactly(PAIR, 50e-6, -50e-6)
    assert 50e-6 * time - 25e-6 * time**2 == pytest.approx(-PAIR.peak)


CROSSINGS = [(50e-6, 3.0, True), (50e-6, 0.5, False), (800e-6, 1.0, False)]


@pytest.mark.parametrize("rate, power, captured", CROSSINGS)
def test_a_crossing_source_captures_the_loop_if_it_is_loud_or_slow(rate, power, captured):
    # 300 trials each; the shares are near 0 or 1, their standard error below 3 %.
    time = steps(2e-3 / rate)
    crossing = -1e-3 + rate * time
    noise = np.random.default_rng(91).standard_normal((2, len(time), 300))
    estimate = dt.track(TwoSourceObserver(PAIR, np.zeros(len(time)), crossing, power, noise), PAIR, Loop(0.3))
    assert (np.mean(dt.lost(PAIR, estimate[-1])) > 0.5) == captured


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: Loop(time_constant=0.0), "time_constant must be above 0"),
        (lambda: Loop(memory=0.0), "memory must be above 0"),
        (lambda: KalmanTracker(interval=-0.1), "interval"),
        (lambda: KalmanTracker(intensity=-1.0), "intensity must not be negative"),
        (lambda: KalmanTracker(form="magic"), "form must be one of"),
        (lambda: dt.loop_gain(replace(PAIR, signal_power=0.0), 0.3), "signal_power must be above 0"),
        (lambda: dt.delay_jitter(-1e-12, 0.3), "K must not be negative"),
        (lambda: dt.step_response(PAIR, 1 / 3000, 0.3, 1.0), "error must stay within"),
        (lambda: dt.maximum_fade(PAIR, 0.0), "rate must not be 0"),
        (lambda: dt.gyro_rate(50.0, 0.04, 0.01), "mean_delay must lie between"),
        (lambda: dt.gyro_rate(0.0, 0.0, 0.01), "spacing"),
    ],
)
def test_bad_input_is_refused_in_words(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def silent_observer(trials=1):
    return BasebandObserver(PAIR, np.zeros(50), np.zeros((2, 50, trials)))


def test_gains_that_make_the_loop_unstable_are_refused_at_the_edge_of_stability():
    with pytest.raises(ValueError, match="unstable"):
        dt.track(silent_observer(), PAIR, Loop(PAIR.step / 2))
    with pytest.raises(ValueError, match="unstable"):
        dt.track_with_gain_control(silent_observer(), PAIR, Loop(PAIR.step))
    nearly = dt.track(silent_observer(), PAIR, Loop(0.51 * PAIR.step), start=1e-6)
    assert abs(nearly[-1, 0]) < 1e-6


def test_starts_and_intervals_that_do_not_fit_are_refused():
    with pytest.raises(ValueError, match="interval must be a whole number"):
        dt.track_kalman(silent_observer(), PAIR, KalmanTracker(interval=0.0101))
    with pytest.raises(ValueError, match="broadcast"):
        dt.track(silent_observer(3), PAIR, Loop(), start=np.zeros(4))
