"""Many trials of a study, in batches, on as many workers as there are, with the same result for any number.

A study is a function `study(rng, trials)` that runs so many trials at once and returns an array, or a dict or
tuple of arrays, with the trials on the first axis. Each batch draws from its own generator, spawned from the
seed, and linear algebra runs on one thread, so neither the order of the batches nor the number of workers
leaves a trace in the numbers; joblib hands the batches out.
"""

import sys
import time
import warnings
from concurrent.futures import BrokenExecutor

import numpy as np

from labsim.arguments import require_positive, require_whole

ATTEMPTS = 3


def run(study, trials, seed, batch=100, workers=None, progress=False, patience=600.0):
    """Run a study batch by batch and return its results, joined along the trials.

    study    : function of (rng, trials), as above; it must not keep anything between calls
    trials   : how many trials in all
    seed     : whole number from which each batch's seed is spawned
    batch    : trials in one batch; with the seed and the machine it settles the result, to the last bit
    workers  : processes; -1 for one on each core. With None, joblib's active backend decides, in this process
               where none is set: `with joblib.parallel_config("dask"):` runs the batches on the Dask cluster
               whose `distributed.Client` is open.
    progress : show on the standard error stream how many trials are done
    patience : s, how long to wait for the next of the batches that run elsewhere

    When a worker process is lost, its batches run again. Nothing is dropped: RuntimeError when workers were
    lost three times, TimeoutError when no batch came for as long as `patience` (joblib does not hear of it
    when a Dask cluster gives a batch up), and any error of the study all name the batches that are missing.
    Raises ValueError for counts that are not whole and positive, and for results of the wrong length.
    """
    from multiprocessing import TimeoutError as Waited  # joblib's way to say it

    trials, batch = require_whole("trials", trials, 1), require_whole("batch", batch, 1)
    require_positive("patience", patience)
    sizes = [min(batch, trials - start) for start in range(0, trials, batch)]
    seeds = np.random.SeedSequence(seed).spawn(len(sizes))
    parts, began = {}, time.monotonic()
    for attempt in range(1, ATTEMPTS + 1):
        left = [(study, i, seeds[i], sizes[i]) for i in range(len(sizes)) if i not in parts]
        try:
            for index, part in _results(left, workers, patience):
                parts[index] = part
                if progress:
                    _show(sum(sizes[i] for i in parts), trials, time.monotonic() - began)
            return _joined([parts[i] for i in range(len(sizes))])
        except BrokenExecutor as error:
            if attempt == ATTEMPTS:
                raise RuntimeError(f"workers were lost {ATTEMPTS} times; {_missing(parts, sizes)}") from error
        except Waited as error:
            raise TimeoutError(f"no batch came for {patience:g} s; {_missing(parts, sizes)}") from error
        except Exception as error:
            error.add_note(_missing(parts, sizes))
            raise


def _results(batches, workers, patience):
    """The results of the batches, each as soon as it is there."""
    from joblib import Parallel, delayed  # a quarter of a second, spared to those who run no study
    from threadpoolctl import threadpool_limits

    parallel = Parallel(workers, batch_size=1, timeout=patience, return_as="generator_unordered")
    with threadpool_limits(1), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "The backend class 'SequentialBackend' does not support timeout")
        yield from parallel(delayed(_batch)(*batch) for batch in batches)


def _batch(study, index, seed, trials):
    from threadpoolctl import threadpool_limits

    threadpool_limits(1)
    part = study(np.random.default_rng(seed), trials)
    for array in part.values() if isinstance(part, dict) else part if isinstance(part, tuple) else [part]:
        if np.shape(array)[:1] != (trials,):
            raise ValueError(
                f"study must return arrays of {trials} trials here, but {np.shape(array)} came back"
            )
    return index, part


def _joined(parts):
    if isinstance(parts[0], dict):
        return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    if isinstance(parts[0], tuple):
        return tuple(np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return np.concatenate(parts)


def _missing(parts, sizes):
    missing = [str(i) for i in range(len(sizes)) if i not in parts]
    return f"of batches 0 to {len(sizes) - 1}, these are missing: {', '.join(missing)}"


def _show(done, trials, seconds):
    end = "\n" if done == trials else ""
    print(f"\r{done} of {trials} trials, {seconds:.0f} s", end=end, file=sys.stderr, flush=True)
