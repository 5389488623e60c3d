"""What Binder builds from: the pinned environment, a supported Python, and a check that all is there."""

import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from conftest import ROOT

BINDER = ROOT / "binder"


def test_binder_installs_the_pinned_environment():
    (line,) = (BINDER / "requirements.txt").read_text(encoding="utf-8").splitlines()
    assert line.startswith("-r ")
    assert (BINDER / line[3:]).resolve() == ROOT / "environment.txt"
    assert "-e ." in (ROOT / "environment.txt").read_text(encoding="utf-8").splitlines()


def test_binder_runs_a_supported_python():
    (wanted,) = re.findall(r"^python-3\.(\d+)$", (BINDER / "runtime.txt").read_text(encoding="utf-8").strip())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    (oldest,) = re.findall(r">=3\.(\d+)", project["requires-python"])
    assert int(wanted) >= int(oldest)


@pytest.mark.skipif(os.name == "nt", reason="Binder runs Linux")
def test_the_build_ends_with_a_complete_lab():
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    assert os.access(BINDER / "postBuild", os.X_OK)
    subprocess.run([BINDER / "postBuild"], cwd=ROOT, env={**os.environ, "PATH": path}, check=True)
