"""The pictures of chapters 01 and 02 show the numbers they are given, and say them in a sentence."""

import numpy as np

from labsim.views import doa_error_vs_snr, signal_model


def painted(view):
    view.figure.canvas.draw()
    return np.asarray(view.figure.canvas.buffer_rgba()).copy()


def level_result(peak=14.0):
    time = np.linspace(0, 60, 61)
    return dict(
        track=np.stack([10 * time - 300, 100 + 0 * time], axis=1), time=time,
        snr_db=peak - (time - 20) ** 2 / 50,
        closest=20.0, closest_range=174.0, width=24.0,
    )  # fmt: skip


def test_the_level_view_marks_the_peak():
    view = signal_model.LevelView(level_result())
    sentence = view.draw(level_result(peak=10.0))
    assert "after 20.0 s" in sentence and "10.0 dB" in sentence and "24.0 s" in sentence
    assert [view.mark.get_xdata()[0], view.mark.get_ydata()[0]] == [20.0, 10.0]


def test_a_slider_step_of_the_level_view_leaves_the_background_alone():
    view = signal_model.LevelView(level_result())
    view.draw(level_result())
    painted(view)
    view.figure.stale = False
    view.draw(level_result(peak=20.0))
    assert not view.figure.stale


def test_the_hodograph_points_to_the_estimate_and_its_opposite():
    rng = np.random.default_rng(1)
    signal = rng.standard_normal(500)
    result = dict(
        velocity=signal[:, None] * [0.6, 0.8, 0],
        pressure=signal,
        axis=0.9273,
        estimate=0.9273,
        truth=0.93,
        slim=0.0,
    )
    view = signal_model.HodographView()
    sentence = view.draw(result)
    assert "53° or 233°" in sentence and "decides for 53.1°" in sentence
    assert "disc" in view.draw(result | dict(slim=0.9)) and "line up" not in view.draw(
        result | dict(slim=0.9)
    )
    assert "along 0° or 180°" in view.draw(result | dict(axis=np.pi - 1e-4))
    end = view.ray.get_xydata()[-1]
    np.testing.assert_allclose(end / np.linalg.norm(end), [0.6, 0.8], atol=1e-3)


def test_the_retardation_view_says_how_far_behind_the_sound_left():
    result = dict(
        track=np.zeros((3, 2)), now=np.array([30.0, 40.0]), heard=np.array([30.0, 38.0]), delay=0.2,
        time=np.arange(4), error_deg=np.zeros(4), expected_deg=np.array([0, -0.5, 0.1, 0]),
        moment=12.0, corrected=False,
    )  # fmt: skip
    sentence = signal_model.RetardationView().draw(result)
    assert "2.0 m behind" in sentence and "0.50°" in sentence and "where it is" in sentence


def test_the_edge_view_tells_coming_from_going():
    result = dict(
        frequency=np.arange(760, 840), level_db=np.zeros(80), edge=794.0, moment=50.0, range_rate=11.25
    )
    view = signal_model.EdgeView(800)
    assert "going away at 11.2 m/s" in view.draw(result)
    assert "coming closer" in view.draw(result | dict(range_rate=-3.0))
    assert "keeps its distance" in view.draw(result | dict(range_rate=0.0))


def test_the_error_view_marks_the_least_expected_error():
    time = np.linspace(0.25, 59.75, 120)
    curve = np.stack([1 + np.abs(time - 30), 2 + np.abs(time - 10)])
    view = doa_error_vs_snr.ErrorView()
    sentence = view.draw(dict(time=time, one=curve, rmse=curve, expected=curve, trials=7))
    assert sentence.startswith("RMSE over 7 records") and "near 30 s" in sentence and "near 10 s" in sentence


def test_the_regime_view_hides_a_regime_that_has_no_room():
    snr_db = np.arange(-20, 31, 5)
    curve = np.linspace(-21, 31, 20)
    flat = np.ones(20)
    view = doa_error_vs_snr.RegimeView()
    result = dict(snr_db=snr_db, measured=np.ones(11), curve_db=curve, expected=flat, bound=flat, simple=flat)
    view.draw(result | dict(cliff_db=-10.0))
    assert [name.get_visible() for name in view.names] == [True, True, True]
    view.draw(result | dict(cliff_db=8.0))
    assert [name.get_visible() for name in view.names] == [True, False, True]


def test_the_window_view_hides_the_closed_form_until_asked():
    windows = np.geomspace(0.05, 20, 9)
    result = dict(
        window=0.5, measured=0.6, windows=windows, noise=windows, lag=windows, total=windows, best=2.4
    )
    view = doa_error_vs_snr.WindowView()
    assert "closed form" not in view.draw(result | dict(revealed=False))
    assert np.isnan(view.total.get_ydata()).all() and not view.key.get_visible()
    assert "best window at 2.4 s" in view.draw(result | dict(revealed=True))
    assert view.key.get_visible()


def test_the_window_view_keeps_the_windows_tried_until_the_scene_changes():
    windows = np.geomspace(0.05, 20, 9)
    result = dict(noise=windows, lag=windows, total=windows, windows=windows, best=2.4, revealed=False)
    view = doa_error_vs_snr.WindowView()
    for window in (0.5, 1.0, 2.0):
        view.draw(result | dict(window=window, measured=1 / window))
    np.testing.assert_allclose(view.tried.get_xydata(), [[0.5, 2.0], [1.0, 1.0]])
    view.draw(result | dict(window=4.0, measured=3.0, total=2 * windows))
    assert view.tried.get_xydata().size == 0


def test_the_regime_view_draws_no_bound_below_the_cliff():
    curve = np.linspace(-21, 31, 53)
    flat = np.ones(53)
    view = doa_error_vs_snr.RegimeView()
    result = dict(curve_db=curve, expected=flat, bound=flat, simple=flat, cliff_db=-6.0)
    view.draw(result | dict(snr_db=np.arange(-20, 31, 5), measured=np.ones(11)))
    assert view.bound.get_xdata().min() == -6.0 and "below -6 dB" in view.title.get_text()


def test_the_overhead_and_contest_views_say_their_numbers():
    directions = np.array([[0.0, 0.6, 0.8]] * 3)
    angles = np.arange(1.0, 90)
    overhead = dict(
        estimates=directions, truth=directions[0], angle_deg=37.0, azimuth_rmse=3.0, sphere_rmse=1.5,
        angles_deg=angles, azimuth_curve=angles, sphere_curve=angles,
    )  # fmt: skip
    assert "3.00°" in doa_error_vs_snr.OverheadView().draw(overhead)
    contest = dict(
        snr_db=np.array([-5, 0, 5]), intensity=np.array([1.5, 1.3, 1.1]), likeliest=np.ones(3),
        curve_db=angles, curve=angles, ratio=1 / 3,
    )  # fmt: skip
    sentence = doa_error_vs_snr.ContestView().draw(contest)
    assert "0.33 times" in sentence and "1.30 times the bound" in sentence


def test_the_record_view_draws_the_whole_record():
    time = np.arange(6000) / 100
    result = dict(
        time=time, pressure=np.sin(time), frequency=np.arange(0, 1000, 25.0), level_db=np.zeros((40, 20)),
        window_time=np.arange(60.0), measured_db=np.full(60, 9.0), expected_db=np.linspace(14, 4, 60),
        closest=3.0,
    )  # fmt: skip
    view = signal_model.RecordView()
    assert "peaks at 14.0 dB" in view.draw(result)
    assert np.ptp(painted(view)) > 0
