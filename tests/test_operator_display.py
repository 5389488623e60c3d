import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from labsim import operator_display as display
from labsim import passive_ranging as pr
from labsim.delay_tracking import Loop, loop_constant, track_with_gain_control
from labsim.discriminator import Correlogram, Pair, WaveformObserver
from labsim.motion import straight_track
from labsim.operator_display import DisplayScenario

ARRAY = pr.Triplet()
SCENARIO = DisplayScenario()
OFFSETS = np.linspace(-0.6e-3, 0.6e-3, 61)
LIMIT = SCENARIO.pair.peak


def heard_from(track, time):
    level = track.position(time)
    place = np.concatenate([level, np.zeros_like(level[:, :1])], axis=-1)
    return np.stack(pr.arrival_delays(ARRAY, place)), np.linalg.norm(level, axis=-1)


@pytest.fixture(scope="module")
def target():
    return heard_from(straight_track((700.0, 4950.0), 5.0, np.radians(-10)), SCENARIO.time)


@pytest.fixture(scope="module")
def records(target):
    """Six records of a vessel at 5 km, with a fade of 8 s and another vessel crossing for 30 s."""
    other, _ = heard_from(straight_track((110.0, 2035.0), 3.6, np.radians(-14)), SCENARIO.time)
    return [
        display.simulate_record(np.random.default_rng(300 + k), SCENARIO, target[0], other) for k in range(6)
    ]


@pytest.fixture(scope="module")
def tracked(records, target):
    """What an automatic tracker that starts on the truth makes of them: (steps, records, pairs), s."""
    steps = [record.steps for record in records]
    quadrature = np.concatenate([each.quadrature for each in steps])
    rows = Correlogram(steps[0].lags, quadrature, np.concatenate([each.in_phase for each in steps]))
    start, rate = np.tile(target[0][:, 0], 6), np.tile(target[0][:, 8000] - target[0][:, 0], 6)
    loop = Loop(0.3, memory=1.2)
    return track_with_gain_control(WaveformObserver(rows), SCENARIO.pair, loop, start, rate).reshape(-1, 6, 2)


def seconds_of(delays):
    return delays[:, 4000::8000]


def manual_lines(record, truth, seed):
    """An operator's straight lines, up to 40 us off at both ends."""
    ends = seconds_of(truth)[:, [0, -1]] + np.random.default_rng(seed).uniform(-40e-6, 40e-6, (2, 2))
    return np.stack([display.straight_line(record.time, *pair) for pair in ends])


def curvature_of(delays):
    return pr.curvature_from_delays(ARRAY, *pr.mean_and_difference(*delays))


def test_operator_with_mask_reads_range_within_a_percent_and_ten_times_better_than_the_machine(
    records, tracked, target
):
    # Six records: the rms of the operator has a standard error of 30 % of itself.
    truth, distance = target
    true_range = np.interp(75.0, SCENARIO.time, distance)
    with_mask, by_hand, without = [], [], []
    for seed, record in enumerate(records):
        picks = display.pick_delays(record, manual_lines(record, truth, seed), OFFSETS, LIMIT)
        keep = display.trustworthy_seconds(record, picks)
        hand = display.kept_seconds(record.time, (43, 55), (93, 127))
        everything = np.ones(record.time.size)
        for result, kept in ((with_mask, keep), (by_hand, hand), (without, everything)):
            result.append(display.read_range(record.time, curvature_of(picks), kept).target_range)
    averages = tracked.reshape(150, 50, 6, 2).mean(axis=1)
    automatic = [pr.range_of_average(curvature_of(averages[:, k].T)) for k in range(6)]
    errors = [
        np.sqrt(np.mean((np.array(r) / true_range - 1) ** 2))
        for r in (with_mask, by_hand, without, automatic)
    ]
    assert errors[0] < 0.01 and errors[1] < 0.01
    assert errors[2] > 5 * errors[1]
    assert errors[3] > 10 * errors[0]


def test_the_false_source_captures_the_automatic_tracker_and_the_fade_does_not(tracked, target):
    error = np.abs(tracked - target[0][:, 80::160].T[:, None, :])
    assert np.all(error[2000] < LIMIT)
    assert np.count_nonzero(np.all(error[3000:4700] < LIMIT, axis=(0, 2))) >= 4
    assert np.all(np.any(error[7000:] > LIMIT, axis=(0, 2)))


def test_mask_of_the_simulated_operator_strikes_out_the_bad_stretches(records, target):
    for seed, record in enumerate(records[:3]):
        picks = display.pick_delays(record, manual_lines(record, target[0], seed), OFFSETS, LIMIT)
        keep = display.trustworthy_seconds(record, picks)
        assert not np.any(keep[46:52]) and not np.any(keep[96:124])
        assert np.count_nonzero(keep) > 80


def test_picks_in_good_stretches_are_as_exact_as_the_cramer_rao_bound_allows(records, target):
    # Six records of 35 s and two pairs: standard error 3.5 %. One second observed: K / T with 2 T = 1 s.
    errors = []
    for seed, record in enumerate(records):
        picks = display.pick_delays(record, manual_lines(record, target[0], seed), OFFSETS, LIMIT)
        errors.append((picks - seconds_of(target[0]))[:, 5:40])
    assert np.std(errors) == pytest.approx(np.sqrt(2 * loop_constant(SCENARIO.pair)), rel=0.12)


def test_a_line_one_period_off_in_both_pairs_leaves_the_range_alone(records, target):
    record, truth = records[0], seconds_of(target[0])
    hand = display.kept_seconds(record.time, (43, 55), (93, 127))
    slipped = display.pick_delays(record, truth + 1 / 1500, OFFSETS, LIMIT)
    reading = display.read_range(record.time, curvature_of(slipped), hand)
    assert reading.target_range == pytest.approx(5000, rel=0.05)


def test_a_record_that_ends_before_the_fade_and_the_false_source_is_good_throughout(target):
    scenario = DisplayScenario(duration=20.0)
    truth = target[0][:, : scenario.time.size]
    record = display.simulate_record(np.random.default_rng(310), scenario, truth, truth)
    picks = display.pick_delays(record, seconds_of(truth), OFFSETS, LIMIT)
    assert np.max(np.abs(picks - seconds_of(truth))) < 40e-6
    assert record.time.size == 20 and record.steps.quadrature.shape[1] == 1000


@given(st.floats(-0.5e-3, 0.5e-3))
def test_nearest_crossing_finds_the_zero_of_a_sine(zero):
    curve = -np.sin(2 * np.pi * 1500 * (OFFSETS - zero))
    expected = (zero + 1 / 3000) % (1 / 1500) - 1 / 3000
    found = display.nearest_crossing(OFFSETS, curve, 1 / 3000)
    if abs(abs(expected) - 1 / 3000) > 2e-6:
        assert found == pytest.approx(expected, abs=2e-6)


def test_no_crossing_within_the_limit_is_nan():
    assert np.isnan(display.nearest_crossing(OFFSETS, np.ones(61), 1e-3))
    assert np.isnan(display.nearest_crossing(OFFSETS, 0.4e-3 - OFFSETS, 0.2e-3))


def test_rising_zeros_are_not_taken():
    assert np.isnan(display.nearest_crossing(OFFSETS, OFFSETS, 1e-3))


def test_kept_seconds():
    time = np.arange(10) + 0.5
    np.testing.assert_array_equal(
        np.flatnonzero(display.kept_seconds(time, (2, 4), (8, 9))), [0, 1, 4, 5, 6, 7, 9]
    )
    assert np.all(display.kept_seconds(time))


def test_range_is_read_off_a_straight_line_through_the_kept_curvatures():
    time = np.arange(100) + 0.5
    curvature = 1 / 5000 + 1e-7 * (time - 50)
    curvature[30:40] = 1.0
    curvature[50] = np.nan
    reading = display.read_range(time, curvature, display.kept_seconds(time, (30, 40)))
    assert reading.target_range == pytest.approx(5000)
    assert np.count_nonzero(reading.keep) == 89


def test_flat_and_wrong_curvature_read_as_infinite_and_impossible():
    time, keep = np.arange(20.0), np.ones(20)
    assert display.read_range(time, np.zeros(20), keep).target_range == np.inf
    assert np.isnan(display.read_range(time, np.full(20, -1e-4), keep).target_range)


def test_too_few_seconds_give_no_range():
    reading = display.read_range(np.arange(20.0), np.ones(20), np.arange(20) < 5)
    assert np.isnan(reading.target_range) and np.all(np.isnan(reading.line))
    assert np.count_nonzero(reading.keep) == 5


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: DisplayScenario(duration=0.0), "duration must be a whole number from 1"),
        (lambda: DisplayScenario(duration=10.5), "duration must be a whole number from 1"),
        (lambda: DisplayScenario(pair=Pair(step=0.03)), "a second must be a whole number of steps"),
        (lambda: DisplayScenario(fade=(50.0, 40.0)), "fade must be .low, high. with low below high"),
        (lambda: DisplayScenario(false_signal=(-5.0, 20.0)), "false_signal must be .low, high."),
        (lambda: DisplayScenario(false_power=-1.0), "false_power must not be negative"),
        (lambda: display.read_range(np.arange(20.0), np.ones(20), np.ones(19)), "keep must have shape"),
        (lambda: display.nearest_crossing(OFFSETS, np.ones(60), 1e-3), "curves must have shape"),
        (
            lambda: display.simulate_record(
                np.random.default_rng(0),
                DisplayScenario(pair=Pair(step=0.02)),
                np.zeros((2, 9)),
                np.zeros((2, 9)),
            ),
            "delays must have shape",
        ),
    ],
)
def test_bad_input_is_refused_in_words(call, words):
    with pytest.raises(ValueError, match=words):
        call()


def test_lines_that_do_not_fit_the_record_are_refused(records):
    with pytest.raises(ValueError, match="lines must have shape"):
        display.sweep(records[0], np.zeros((2, 10)), OFFSETS)
