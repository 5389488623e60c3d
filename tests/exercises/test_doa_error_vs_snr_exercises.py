"""Feedback on the exercises of chapter 02: right answers, typical mistakes, and none."""

import pytest

from labsim.exercises import doa_error_vs_snr as exercises
from labsim.vector_sensor import cramer_rao_bound, intensity_error


@pytest.mark.parametrize(
    ("exercise", "right", "wrong"),
    [
        (exercises.rmse_at_17_db, 0.334, 0.385),
        (exercises.rmse_at_17_db, 0.333, 0.472),
        (exercises.bandwidth_for_half_window, 1200, 2400),
        (exercises.optimal_noise_ratio, 24.4, 0.041),
        (exercises.best_window_at_30_db, 1.18, 2.4),
    ],
)
def test_answers_are_judged(exercise, right, wrong):
    assert exercise(right).right
    assert exercise(wrong).status == "look again" and exercise(wrong).hint
    assert exercise(...).status == "not answered yet"


def test_the_noise_ratio_found_brings_intensity_within_one_percent_of_the_bound():
    excess = intensity_error(1.0, 300, 24.4) / cramer_rao_bound(1.0, 300, 24.4)
    assert excess == pytest.approx(1.01, abs=1e-4)
