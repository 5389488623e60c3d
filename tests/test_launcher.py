"""The one command: what it says when something is missing, and how the next run repairs it."""

import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

from labsim import __main__ as launcher

ROOT = Path(__file__).parents[1]


@pytest.fixture
def clone(tmp_path, monkeypatch):
    """A folder with pins but no environment, in which pip and venv are replaced by recordings."""
    pins = tmp_path / "environment.txt"
    pins.write_text("numpy\n")
    monkeypatch.setattr(launcher, "ROOT", str(tmp_path))
    monkeypatch.setattr(launcher, "PINS", str(pins))
    (tmp_path / "test-environment.txt").write_text("pytest\n")
    monkeypatch.setattr(launcher, "TEST_PINS", str(tmp_path / "test-environment.txt"))
    monkeypatch.setattr(launcher, "ENVIRONMENT", str(tmp_path / ".venv"))
    monkeypatch.setattr(launcher, "STAMP", str(tmp_path / ".venv" / "labsim-installed"))
    calls = []

    def call(command, cwd=None):
        step = next(step for step in ("pytest", "pip", "venv") if step in command)
        calls.append(step)
        if step == "venv":
            python = tmp_path / ".venv" / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
            python.parent.mkdir(parents=True, exist_ok=True)
            python.touch()
        return clone.status.get(step, 0)

    clone.status = {}
    clone.calls = calls
    monkeypatch.setattr(launcher.subprocess, "call", call)
    clone.path = tmp_path
    return clone


def test_second_run_installs_nothing(clone):
    launcher.prepare()
    launcher.prepare()
    assert clone.calls == ["venv", "pip"]


def test_changed_pins_are_installed_into_the_same_environment(clone):
    launcher.prepare()
    (clone.path / "environment.txt").write_text("numpy\nscipy\n")
    launcher.prepare()
    assert clone.calls == ["venv", "pip", "pip"]


def test_failed_install_is_reported_in_words_and_begun_anew(clone, capsys):
    clone.status["pip"] = 1
    assert launcher.main([]) == 1
    said = capsys.readouterr().err
    assert said.startswith("labsim: the packages could not be installed") and "network" in said
    clone.status["pip"] = 0
    launcher.prepare()
    assert clone.calls == ["venv", "pip", "venv", "pip"]


def test_failed_update_does_not_pass_for_finished(clone):
    launcher.prepare()
    (clone.path / "environment.txt").write_text("numpy\nscipy\n")
    clone.status["pip"] = 1
    with pytest.raises(launcher.Problem):
        launcher.prepare()
    clone.status["pip"] = 0
    launcher.prepare()
    assert clone.calls == ["venv", "pip", "pip", "venv", "pip"]


def test_moved_folder_is_installed_again(clone, monkeypatch):
    launcher.prepare()
    before = launcher.fingerprint(launcher.PINS)
    monkeypatch.setattr(launcher, "ROOT", str(clone.path / "elsewhere"))
    assert launcher.fingerprint(launcher.PINS) != before


def test_old_python_is_told_what_it_needs(clone, monkeypatch, capsys):
    monkeypatch.setattr(launcher.sys, "version_info", (3, 9, 2, "final", 0))
    assert launcher.main(["test"]) == 1
    assert "this is Python 3.9, but the lab needs Python 3.11 or newer" in capsys.readouterr().err


def test_old_python_can_read_the_launcher():
    source = Path(launcher.__file__).read_text(encoding="utf-8")
    tree = ast.parse(source, feature_version=(3, 5))
    assert not [node for node in ast.walk(tree) if isinstance(node, ast.JoinedStr)]


@pytest.mark.parametrize("missing", ["venv", "ensurepip"])
def test_missing_venv_module_is_named(clone, monkeypatch, capsys, missing):
    monkeypatch.setattr(launcher, "find_spec", lambda name: None if name == missing else object())
    assert launcher.main([]) == 1
    assert "python3-venv" in capsys.readouterr().err


def test_read_only_folder_is_named(clone, monkeypatch, capsys):
    def refuse():
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(launcher, "check_writable", refuse)
    assert launcher.main([]) == 1
    said = capsys.readouterr().err
    assert "Permission denied" in said and "folder that you may write to" in said
    assert clone.calls == []


def test_missing_pins_are_named(clone, capsys):
    (clone.path / "environment.txt").unlink()
    assert launcher.main([]) == 1
    assert "environment.txt is missing" in capsys.readouterr().err


def test_help_explains_both_commands():
    shown = subprocess.run(
        [sys.executable, "-m", "labsim", "--help"], cwd=ROOT, capture_output=True, text=True
    )
    assert shown.returncode == 0
    assert "labsim test" in shown.stdout and "--no-browser" in shown.stdout


def test_importing_the_package_loads_nothing_heavy():
    heavy = ("numpy", "scipy", "matplotlib", "ipywidgets")
    code = f"import sys, labsim; print([name for name in {heavy} if name in sys.modules])"
    shown = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert shown.stdout.strip() == "[]"


def test_arguments_reach_jupyterlab(clone, monkeypatch):
    commands = []
    monkeypatch.setattr(launcher, "run", lambda command: commands.append(command) or 0)
    launcher.main(["--no-browser", "--port", "8899"])
    assert commands[0][-3:] == ["--no-browser", "--port", "8899"]
    launcher.main(["test", "-k", "floors"])
    assert commands[1][1:] == ["-m", "pytest", "-k", "floors"]


def test_apps_serve_the_notebooks_and_pass_options_on(clone, monkeypatch):
    commands = []
    monkeypatch.setattr(launcher, "run", lambda command: commands.append(command) or 0)
    assert launcher.main(["apps", "--no-browser", "--port", "8866"]) == 0
    assert commands[0][1:4] == ["-m", "voila", "notebooks"]
    assert commands[0][-3:] == ["--no-browser", "--port", "8866"]


def test_environment_made_by_hand_is_left_alone(clone, capsys):
    (clone.path / ".venv" / "bin").mkdir(parents=True)
    assert launcher.main([]) == 1
    assert "this command did not make it" in capsys.readouterr().err
    assert (clone.path / ".venv" / "bin").is_dir() and clone.calls == []


def test_tests_add_their_packages_once_and_the_lab_stays_finished(clone, monkeypatch):
    monkeypatch.setattr(launcher, "run", lambda command: 0)
    for command in ([], ["test"], ["test"], []):
        assert launcher.main(command) == 0
    assert clone.calls == ["venv", "pip", "pip", "pytest", "pytest", "pytest", "pytest"]


@pytest.mark.parametrize("statuses", [(0, 0), (1, 0), (0, 1)])
def test_all_tests_run_once_each_and_a_failure_of_either_part_counts(monkeypatch, statuses):
    commands, left = [], list(statuses)
    monkeypatch.setattr(
        launcher.subprocess, "call", lambda command, cwd: commands.append(command) or left.pop(0)
    )
    assert launcher.run_tests(sys.executable, []) == max(statuses)
    together, alone = commands
    left_out = [option.removeprefix("--ignore=") for option in together if option.startswith("--ignore=")]
    assert left_out == alone[3:] and all((ROOT / name).exists() for name in left_out)


def test_lab_opens_although_the_packages_of_the_tests_failed(clone, monkeypatch):
    monkeypatch.setattr(launcher, "run", lambda command: 0)
    launcher.prepare()
    clone.status["pip"] = 1
    assert launcher.main(["test"]) == 1
    assert launcher.main([]) == 0
    assert clone.calls == ["venv", "pip", "pip"]
