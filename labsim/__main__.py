"""python3 -m labsim: make the lab's environment where there is none, then open the lab or test it.

Needs Python and its standard library alone, and is written so that an old Python can say it is too old.
"""

import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
from importlib.util import find_spec

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
ENVIRONMENT = os.path.join(ROOT, ".venv")
PINS = os.path.join(ROOT, "environment.txt")
TEST_PINS = os.path.join(ROOT, "tests", "environment.txt")
TIMED_TESTS = ["tests/benchmarks", "tests/test_apps.py", "tests/test_browser.py"]
STAMP = os.path.join(ENVIRONMENT, "labsim-installed")
OLDEST = (3, 11)
UNFINISHED = "unfinished"

HELP = """\
python3 -m labsim [JUPYTERLAB OPTIONS]   open the lab in the browser, at its first notebook
python3 -m labsim apps [VOILA OPTIONS]   open the chapters as pages of sliders and text, without code
python3 -m labsim test [PYTEST OPTIONS]  run every test, the notebooks among them
python3 -m labsim figures [--paper N] [--out DIR]
                                         write every reproduced figure and table to files
python3 -m labsim --help                 this text

The first run makes the environment in .venv from environment.txt: two or three minutes with a
network. Later runs start at once. For example, on a machine without a screen:
    python3 -m labsim --no-browser --port 8899
To begin afresh, delete the folder .venv."""


class Problem(Exception):
    """One plain sentence that says what is wrong and what to do."""


def main(arguments):
    """Run the command and return its exit status."""
    if arguments[:1] in (["--help"], ["-h"]):
        print(HELP)
        return 0
    try:
        python = prepare()
        if arguments[:1] == ["test"]:
            prepare_tests(python)
            return run_tests(python, arguments[1:])
        if arguments[:1] == ["apps"]:
            return run(apps_command(python) + arguments[1:])
        if arguments[:1] == ["figures"]:
            return run([python, "-m", "labsim.figures"] + arguments[1:])
        return run(lab_command(python) + arguments)
    except Problem as problem:
        print("labsim: " + str(problem), file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\nlabsim: stopped; the next run mends what is unfinished.", file=sys.stderr)
        return 130


def run(command):
    """Become the command, so that signals reach it; else run it and return its exit status."""
    if os.name == "posix":
        os.chdir(ROOT)
        os.execv(command[0], command)
    process = subprocess.Popen(command, cwd=ROOT)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    return process.wait()


def run_tests(python, options):
    """Run the tests that options choose; without options all, side by side but for those that take times."""
    pytest = [python, "-m", "pytest"]
    if options:
        return run(pytest + options)
    others = ["--ignore=" + name for name in TIMED_TESTS]
    first = subprocess.call(pytest + ["--numprocesses=auto", "--dist=loadfile"] + others, cwd=ROOT)
    second = subprocess.call(pytest + TIMED_TESTS, cwd=ROOT)
    if first:
        print("labsim: tests failed in the first of the two runs; its summary stands further up.")
    return first or second


def lab_command(python):
    """JupyterLab, run in the lab's folder, opening the start notebook."""
    return [
        python, "-m", "jupyterlab",
        "--LabApp.default_url=/lab/tree/notebooks/00_start_here.ipynb",
    ]  # fmt: skip


def apps_command(python):
    """Voila, which runs a notebook for each visitor and shows all of it but the code."""
    return [python, "-m", "voila", "notebooks", "--classic-tree"]


def prepare():
    """Return the environment's Python, having made or mended the environment if need be."""
    if sys.version_info < OLDEST:
        found = "{}.{}".format(*sys.version_info[:2])
        raise Problem(
            "this is Python " + found + ", but the lab needs Python 3.11 or newer; install one and use it."
        )
    if not os.path.exists(PINS):
        raise Problem(
            "environment.txt is missing; run the command in the folder that the lab was cloned into."
        )
    python = os.path.join(ENVIRONMENT, *(("Scripts", "python.exe") if os.name == "nt" else ("bin", "python")))
    wanted = fingerprint(PINS)
    if os.path.exists(python) and read(STAMP) in (wanted, fingerprint(PINS, TEST_PINS)):
        return python
    if find_spec("venv") is None or find_spec("ensurepip") is None:
        raise Problem(
            "this Python comes without the venv module; install it (on Debian or Ubuntu: "
            "sudo apt install python3-venv) and run the command again."
        )
    print("Making the lab's environment in .venv, once; this takes two or three minutes.", flush=True)
    try:
        check_writable()
        install(python)
        stamp(wanted)
    except OSError as error:
        raise Problem(
            "cannot write to " + ROOT + " (" + str(error.strerror or error) + "); put the lab in a folder "
            "that you may write to, with 1 GB free, and run the command again."
        ) from error
    return python


def install(python):
    """Make the environment, or mend one that this command made before; then install the pinned packages.

    The stamp says whose folder it is: there from the beginning, it tells an unfinished environment of the
    lab, which is made anew, from one that somebody made by hand, which is left alone.
    """
    state = read(STAMP)
    if state is None and os.path.isdir(ENVIRONMENT) and os.listdir(ENVIRONMENT):
        raise Problem(
            "the folder .venv is there, but this command did not make it; rename or delete it and run the "
            "command again, or go on using it with the plain commands of the README."
        )
    if state == UNFINISHED or not os.path.exists(python):
        shutil.rmtree(ENVIRONMENT, ignore_errors=True)
        os.makedirs(ENVIRONMENT)
        stamp(UNFINISHED)
        if subprocess.call([sys.executable, "-m", "venv", ENVIRONMENT]):
            raise Problem("Python could not make an environment in .venv; see its message above.")
    stamp(UNFINISHED)
    pip_install(python, PINS)
    write_settings()


def prepare_tests(python):
    """Install what the tests need besides; should that fail, the lab itself still opens."""
    wanted = fingerprint(PINS, TEST_PINS)
    if read(STAMP) != wanted:
        print("Adding what the tests need to the lab's environment, once.", flush=True)
        pip_install(python, TEST_PINS)
        stamp(wanted)


def pip_install(python, pins):
    """Install the packages of one file of pins."""
    pip = [python, "-m", "pip", "--disable-pip-version-check", "install", "--no-compile", "--no-input"]
    if subprocess.call(pip + ["--requirement", pins], cwd=ROOT):
        raise Problem(
            "the packages could not be installed; see pip's message above. If there is no network, "
            "connect to one and run the command again."
        )


def stamp(text):
    """Write what the environment's stamp says."""
    with open(STAMP, "w", encoding="utf-8") as file:
        file.write(text)


def write_settings():
    """Spare a newcomer JupyterLab's questions about news and its look for updates of a pinned version."""
    folder = os.path.join(ENVIRONMENT, "share", "jupyter", "lab", "settings")
    os.makedirs(folder, exist_ok=True)
    settings = {
        "@jupyterlab/apputils-extension:notification": {"fetchNews": "false", "checkForUpdates": False}
    }
    with open(os.path.join(folder, "overrides.json"), "w", encoding="utf-8") as file:
        json.dump(settings, file)


def check_writable():
    """Raise OSError where the lab's folder takes no new file."""
    probe = os.path.join(ROOT, ".labsim-probe")
    with open(probe, "w"):
        pass
    os.remove(probe)


def fingerprint(*files):
    """What an environment depends on: files of pins, this Python, and where the lab lies."""
    parts = repr((sys.version_info[:2], ROOT)).encode()
    for name in files:
        with open(name, "rb") as pins:
            parts += pins.read()
    return hashlib.sha256(parts).hexdigest()


def read(path):
    """The text of a small file, or None where there is none."""
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except OSError:
        return None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
