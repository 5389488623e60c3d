"""Version, citation, changes and supported Pythons tell one story."""

import re
import tomllib
from pathlib import Path

import yaml

import labsim

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def test_citation_and_changes_name_the_version_and_its_day():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    newest = re.search(r"^## (\S+), (\S+)$", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.M)
    assert (citation["version"], str(citation["date-released"])) == newest.groups()
    assert citation["version"] == labsim.__version__
    assert citation["license"] == PROJECT["license"]


def test_oldest_python_is_the_first_that_is_listed():
    listed = re.findall(r"Python :: (3\.\d+)", "\n".join(PROJECT["classifiers"]))
    assert PROJECT["requires-python"] == ">=" + listed[0]


def test_readme_installs_the_cluster_beside_the_lab_itself():
    """Asked for a second time, the lab must be asked for in the same way: pip refuses two kinds."""
    (line,) = re.findall(
        r"`pip install ([^`]*cluster[^`]*)`", (ROOT / "README.md").read_text(encoding="utf-8")
    )
    assert line == '-r environment.txt -e ".[cluster]"'
    assert "-e ." in (ROOT / "environment.txt").read_text(encoding="utf-8").splitlines()


def test_every_direct_dependency_is_pinned():
    files = ("environment.txt", "tests/environment.txt")
    pins = "".join((ROOT / name).read_text(encoding="utf-8") for name in files)
    extras = PROJECT["optional-dependencies"]
    for name in [*PROJECT["dependencies"], *extras["test"], *extras["cluster"], *extras["apps"]]:
        assert re.findall(rf"^{name}==\S+( ; .*)?$", pins, re.M), name
