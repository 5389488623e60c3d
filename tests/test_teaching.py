"""What the instructor's page says of the notebooks is true of the notebooks."""

import json
import re

import pytest
from conftest import CHAPTERS, PLACES_ON_A_MACHINE, ROOT, code_cells, read_notebook, source

NOTEBOOKS = ROOT / "notebooks"
PAGE = (NOTEBOOKS / "README.md").read_text(encoding="utf-8")
LABEL = re.compile(r'(?:slider|choice|switch|interval)\(\s*"([^"]+)"')


def rows(title):
    """The cells of the table under a heading, row by row, without its head."""
    text = PAGE.split(f"## {title}\n")[1].split("\n## ")[0]
    table = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in table[2:]]


def chapter(number):
    (path,) = [path for path in CHAPTERS if path.stem.startswith(number)]
    return path


def markdown(path):
    return "\n".join(source(cell) for cell in read_notebook(path)["cells"] if cell["cell_type"] == "markdown")


def test_every_chapter_has_its_row_and_its_time():
    listed = {row[0].strip("[").split("]")[0][:2]: row for row in rows("The chapters")}
    for path in CHAPTERS:
        (minutes,) = re.findall(r"\*\*Time:?\*\*:? (\d+) minutes", markdown(path))
        assert listed[path.stem[:2]][2] == minutes, path.stem


@pytest.mark.parametrize("page", ["README.md", "glossary.md"])
def test_links_lead_somewhere(page):
    text = (NOTEBOOKS / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\((?!https?:)([^)#]+)\)", text):
        assert (NOTEBOOKS / target).exists(), target


def test_exercises_listed_are_the_exercises_there():
    for number, *cells in rows("What the exercises train"):
        there = len(re.findall(r"^\*\*\d\. ", markdown(chapter(number)).replace("** ", " ** "), re.MULTILINE))
        listed = len([cell for cell in cells if cell and cell != "|"])
        assert listed == there, f"{number}: {listed} listed, {there} there"


@pytest.mark.parametrize(
    "row", rows("Misconceptions, and the slider that cures them"), ids=lambda row: f"{row[1]} {row[2]}"
)
def test_the_slider_that_cures_is_there(row):
    code = "\n".join(source(cell) for cell in code_cells(read_notebook(chapter(row[1]))))
    assert row[2].strip("*") in LABEL.findall(code)


def test_resources_were_measured_for_every_chapter():
    table = PAGE.split("<!-- measured: begin -->")[1].split("<!-- measured: end -->")[0]
    assert set(re.findall(r"^\| (\d\d_\w+) ", table, re.MULTILINE)) == {path.stem for path in CHAPTERS}


def test_glossary_has_no_term_twice():
    lines = (NOTEBOOKS / "glossary.md").read_text(encoding="utf-8").splitlines()
    terms = [line.split(" | ")[1] for line in lines if line.startswith("| ") and "中文" not in line]
    assert len(terms) >= 60
    assert len(terms) == len(set(terms))


def test_no_output_shows_a_machine_in_the_pages():
    text = PAGE + json.dumps((NOTEBOOKS / "glossary.md").read_text(encoding="utf-8"))
    assert not PLACES_ON_A_MACHINE.search(text)
