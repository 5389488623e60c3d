"""Studies in batches: the same bits on any workers, and no batch dropped when a worker is lost."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import joblib
import numpy as np
import pytest

from labsim import montecarlo


def study(rng, trials):
    """A dict of every kind of draw, with linear algebra that rounds differently on one thread and on two."""
    noise = rng.normal(size=(trials, 90, 90))
    product = noise.reshape(trials * 90, 90).T @ noise.reshape(trials * 90, 90)
    solved = np.linalg.solve(product @ product, noise[:, :, 0, None])[..., 0]
    return {"solved": solved, "wrapped": rng.vonmises(0.0, 2.0, trials), "hits": rng.poisson(3.0, trials)}


def die_once(rng, trials, flag):
    """The study, but the first worker to come here is lost in the middle of its batch."""
    result = study(rng, trials)
    try:
        flag.touch(exist_ok=False)
    except FileExistsError:
        return result
    os.kill(os.getpid(), signal.SIGKILL)


def die_always(rng, trials, caller):
    assert os.getpid() != caller
    os.kill(os.getpid(), signal.SIGKILL)


def squares(rng, trials):
    return rng.normal(size=(trials, 2)) ** 2


def complain_of_the_last(rng, trials):
    if trials < 10:
        raise ArithmeticError("the last batch is short")
    return rng.normal(size=trials)


def long_when_whole(rng, trials):
    """Whole batches of ten take longer than what is left over."""
    time.sleep(0.5 if trials == 10 else 0.0)
    return rng.random(trials)


@pytest.fixture(scope="module")
def serial():
    return montecarlo.run(study, 70, seed=3, batch=10)


def assert_same_bits(one, other):
    assert one.keys() == other.keys()
    for name in one:
        assert one[name].dtype == other[name].dtype
        assert one[name].tobytes() == other[name].tobytes(), name


@pytest.mark.parametrize("backend", ["loky", "threading"])
@pytest.mark.parametrize("workers", [1, 2, 3])
def test_workers_and_backend_leave_no_trace_in_the_numbers(serial, backend, workers):
    with joblib.parallel_config(backend):
        assert_same_bits(montecarlo.run(study, 70, seed=3, batch=10, workers=workers), serial)


def test_batches_that_finish_out_of_turn_are_put_in_order():
    alone, beside = (montecarlo.run(long_when_whole, 13, 4, batch=10, workers=n) for n in (1, 2))
    np.testing.assert_array_equal(beside, alone)


def test_first_batch_is_the_first_spawned_seed(serial):
    first = study(np.random.default_rng(np.random.SeedSequence(3).spawn(1)[0]), 10)
    np.testing.assert_allclose(serial["solved"][:10], first["solved"], rtol=1e-6)
    np.testing.assert_array_equal(serial["hits"][:10], first["hits"])


def test_batches_are_independent_and_every_trial_comes_back_once():
    drawn = montecarlo.run(lambda rng, trials: rng.random(trials), 1234, seed=8, batch=100)
    assert drawn.shape == (1234,)
    assert len(np.unique(drawn)) == 1234


def test_more_trials_keep_the_full_batches_that_were_there():
    few, many = (montecarlo.run(squares, trials, seed=5, batch=50) for trials in (200, 1000))
    np.testing.assert_array_equal(many[:200], few)


def test_a_study_of_pi_agrees_with_theory():
    # 200,000 trials, seed 11: the share of points in the quarter circle, within four standard errors.
    inside = montecarlo.run(
        lambda rng, n: (rng.random((n, 2)) ** 2).sum(axis=1) < 1, 200_000, 11, batch=20_000
    )
    share = np.pi / 4
    assert abs(inside.mean() - share) < 4 * np.sqrt(share * (1 - share) / 200_000)


def test_tuples_and_plain_arrays_keep_their_form():
    pair = montecarlo.run(lambda rng, n: (rng.random(n), rng.random((n, 3))), 25, seed=1, batch=10)
    assert isinstance(pair, tuple) and [a.shape for a in pair] == [(25,), (25, 3)]
    assert montecarlo.run(squares, 25, seed=1, batch=10).shape == (25, 2)


@pytest.mark.parametrize("workers", [1, 2])
def test_error_of_the_study_comes_through_and_names_what_is_missing(workers):
    with pytest.raises(ArithmeticError, match="last batch is short") as raised:
        montecarlo.run(complain_of_the_last, 35, seed=1, batch=10, workers=workers)
    (note,) = raised.value.__notes__
    assert note.startswith("of batches 0 to 3, these are missing: ") and note.endswith("3")


def test_lost_worker_costs_no_batch(serial, tmp_path):
    flag = tmp_path / "lost"
    result = montecarlo.run(partial(die_once, flag=flag), 70, seed=3, batch=10, workers=2)
    assert flag.exists()
    assert_same_bits(result, serial)


def test_workers_lost_again_and_again_end_in_words():
    with pytest.raises(RuntimeError, match="lost 3 times; of batches 0 to 3, these are missing: 0, 1, 2, 3"):
        montecarlo.run(partial(die_always, caller=os.getpid()), 40, seed=1, batch=10, workers=2)


def test_dask_cluster_gives_the_same_bits_and_survives_a_lost_worker(serial, tmp_path):
    distributed = pytest.importorskip("distributed")
    flag = tmp_path / "lost"
    with (
        distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster),
        joblib.parallel_config("dask"),
    ):
        assert_same_bits(montecarlo.run(study, 70, seed=3, batch=10), serial)
        assert_same_bits(montecarlo.run(partial(die_once, flag=flag), 70, seed=3, batch=10), serial)
        assert flag.exists()


def test_readme_example_gives_the_same_bits_here_and_on_a_cluster():
    distributed = pytest.importorskip("distributed")
    readme = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
    code = readme.split("```python\n")[1].split("```")[0].replace("100_000", "2_000")
    with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster:
        names = {"__name__": "readme"}
        exec(code.replace("address-of-the-scheduler:8786", cluster.scheduler_address), names)
    assert names["here"].shape == (2_000, 1)
    assert names["here"].tobytes() == names["there"].tobytes()


def test_dask_cluster_that_keeps_losing_workers_says_what_is_missing():
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster),
        joblib.parallel_config("dask"),
        pytest.raises(
            TimeoutError, match="no batch came for 6 s; of batches 0 to 1, these are missing: 0, 1"
        ),
    ):
        montecarlo.run(partial(die_always, caller=os.getpid()), 20, seed=1, batch=10, patience=6)


def test_backend_that_cannot_report_batch_by_batch_is_refused_in_words():
    with (
        joblib.parallel_config("multiprocessing"),
        pytest.raises(ValueError, match="does not support return_as"),
    ):
        montecarlo.run(squares, 20, seed=1, batch=10, workers=2)


def test_progress_is_text_and_silence_is_the_default(capsys):
    montecarlo.run(squares, 25, seed=1, batch=10)
    assert capsys.readouterr() == ("", "")
    montecarlo.run(squares, 25, seed=1, batch=10, progress=True)
    out, err = capsys.readouterr()
    assert out == ""
    assert [line.split(",")[0] for line in err.strip().split("\r")] == [
        f"{n} of 25 trials" for n in (10, 20, 25)
    ]
    assert err.endswith("\n")


@pytest.mark.skipif(os.name == "nt", reason="sends signals to a process group")
@pytest.mark.parametrize("workers", [1, 2])
def test_interrupt_ends_the_study_and_its_workers(workers):
    code = (
        "import time\nfrom labsim import montecarlo\n"
        "def slow(rng, trials):\n    time.sleep(0.2)\n    return rng.random(trials)\n"
        f"montecarlo.run(slow, 1000, seed=1, batch=1, workers={workers}, progress=True)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, start_new_session=True)
    assert process.stderr.read(4) == b"\r1 o"
    os.killpg(process.pid, signal.SIGINT)
    _, said = process.communicate(timeout=120)
    assert process.returncode != 0 and b"KeyboardInterrupt" in said
    deadline = time.monotonic() + 60
    while group_lives(process.pid) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not group_lives(process.pid)


def group_lives(group):
    try:
        os.killpg(group, 0)
    except ProcessLookupError:
        return False
    return True


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"trials": 0}, "trials must be a whole number from 1 up, but 0 was given"),
        ({"trials": 2.5}, "trials must be a whole number from 1 up, but 2.5 was given"),
        ({"trials": "many"}, "trials must be a number"),
        ({"batch": -1}, "batch must be a whole number from 1 up, but -1 was given"),
        ({"batch": np.nan}, "batch must be finite"),
        ({"patience": 0}, "patience must be above 0"),
    ],
)
def test_counts_that_are_none_are_refused(arguments, words):
    with pytest.raises(ValueError, match=words):
        montecarlo.run(squares, **{"trials": 10, "seed": 1, **arguments})


@pytest.mark.parametrize(
    "wrong", [lambda rng, n: 1.0, lambda rng, n: np.ones(n + 1), lambda rng, n: {"a": np.ones(1)}]
)
def test_results_without_a_row_for_each_trial_are_refused(wrong):
    with pytest.raises(ValueError, match="study must return arrays of 7 trials here"):
        montecarlo.run(wrong, 7, seed=1)


def loaded(module):
    """The heavy packages that a fresh Python holds after importing a module."""
    heavy = (
        "numpy",
        "scipy",
        "joblib",
        "matplotlib",
        "ipywidgets",
        "IPython",
        "distributed",
        "dask",
        "pytest",
    )
    code = f"import sys, {module}; print(*[name for name in {heavy} if name in sys.modules])"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(shown.stdout.split())


def test_package_loads_nothing_heavy_and_no_module_below_the_views_loads_pictures_or_widgets():
    from test_floors import MODULES, floor

    assert loaded("labsim") == set()
    below = [f"labsim.{m.as_posix()}" for m in MODULES if floor(m.as_posix()) < 3]
    assert "labsim.montecarlo" in below
    assert loaded(", ".join(below)) <= {"numpy", "scipy"}
