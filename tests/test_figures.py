"""Figures on demand: what is written, that a second run writes the same, and that it resumes."""

import json
import subprocess
import sys

import nbformat
import pytest
from conftest import ROOT

from labsim import figures

CELLS = (
    "import numpy as np\nfrom labsim.checks import Table\nfrom labsim.lab import still\n"
    "from labsim.motion import straight_track\nfrom labsim.views.start_here import PassingView\n"
    "time = np.linspace(0, 60, 61)\nposition = straight_track((-250, 100), 12, 0.2).position(time)",
    "result = dict(time=time, position=position, distance=np.hypot(*position.T), now=7)\n"
    'still(PassingView(result), result, name="paper1_figure9", seed=4, band=(200, 800))',
    'Table(("range", "error"), [("1 km", -0.7)], name="paper3_table9")',
)


@pytest.fixture
def chapter(tmp_path, monkeypatch):
    """A chapter with one figure and one table, as the only one there is."""
    path = tmp_path / "notebooks" / "99_small.ipynb"
    path.parent.mkdir()
    cells = [nbformat.v4.new_code_cell(cell) for cell in CELLS]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), path)
    (tmp_path / "labsim").mkdir()
    monkeypatch.setattr(figures, "ROOT", tmp_path)
    return path


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.name[0] != "."}


def test_figures_and_tables_are_written_with_what_made_them(chapter, tmp_path):
    assert figures.main(["--out", str(tmp_path / "out")]) == 0
    written = files(tmp_path / "out")
    names = {
        "paper1_figure9.svg",
        "paper1_figure9.png",
        "paper1_figure9.json",
        "paper3_table9.csv",
        "paper3_table9.json",
    }
    assert set(written) == names
    said = json.loads(written["paper1_figure9.json"])
    assert said["parameters"] == {"seed": 4, "band": [200, 800]}
    assert said["shows"].startswith("After 7.00 s") and "numpy" in said["versions"]
    assert written["paper3_table9.csv"].split() == [b"range,error", b"1", b"km,-0.7"]


def test_second_run_writes_the_same_bytes(chapter, tmp_path):
    for name in ("first", "second"):
        figures.main(["--out", str(tmp_path / name)])
    assert files(tmp_path / "first") == files(tmp_path / "second")


def test_unchanged_chapter_is_left_alone_and_a_lost_file_is_written_again(chapter, tmp_path, capsys):
    out = tmp_path / "out"
    figures.main(["--out", str(out)])
    figures.main(["--out", str(out)])
    assert capsys.readouterr().out.splitlines()[-1].endswith("unchanged")
    (out / "paper3_table9.csv").unlink()
    figures.main(["--out", str(out)])
    assert (out / "paper3_table9.csv").exists()


def test_interrupted_chapter_is_run_again(chapter, tmp_path, monkeypatch, capsys):
    out, save = tmp_path / "out", figures.save

    def interrupted(shown, folder):
        raise KeyboardInterrupt

    monkeypatch.setattr(figures, "save", interrupted)
    assert figures.main(["--out", str(out)]) == 130
    monkeypatch.setattr(figures, "save", save)
    assert figures.main(["--out", str(out)]) == 0
    assert "paper1_figure9.svg" in files(out)


def test_one_paper_alone(chapter, tmp_path):
    figures.main(["--paper", "3", "--out", str(tmp_path / "out")])
    assert set(files(tmp_path / "out")) == {"paper3_table9.csv", "paper3_table9.json"}


def test_unknown_paper_is_named(chapter, tmp_path, capsys):
    assert figures.main(["--paper", "7", "--out", str(tmp_path / "out")]) == 1
    assert "--paper must be one of 1, 3, not 7" in capsys.readouterr().err


def test_unwritable_folder_is_named(chapter, tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert figures.main(["--out", str(tmp_path / "file" / "out")]) == 1
    assert "choose another with --out" in capsys.readouterr().err


def test_command_knows_its_options():
    shown = subprocess.run(
        [sys.executable, "-m", "labsim.figures", "--help"], cwd=ROOT, capture_output=True, text=True
    )
    assert shown.returncode == 0 and "--paper" in shown.stdout
