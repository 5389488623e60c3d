"""What every notebook of the course must have, read from the committed files; nbval runs them."""

import ast
import json
import re

import pytest
from conftest import CHAPTERS, PLACES_ON_A_MACHINE, ROOT, SOLUTIONS, code_cells, read_notebook, source

LONGEST_CELL = 15
LARGEST_FILE = 1_000_000
PICTURES = ("Lab(", "still(")
EVERY = pytest.mark.parametrize("path", CHAPTERS + SOLUTIONS, ids=lambda path: path.stem)
CHAPTER = pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem)
COURSE = pytest.mark.parametrize(
    "path", [path for path in CHAPTERS if "01" <= path.stem[:2] <= "08"], ids=lambda path: path.stem
)


def headings(notebook):
    text = "\n".join(source(cell) for cell in notebook["cells"] if cell["cell_type"] == "markdown")
    return re.findall(r"^#+ (.+)$", text, flags=re.MULTILINE), text


def outputs(notebook):
    return [output for cell in code_cells(notebook) for output in cell["outputs"]]


@EVERY
def test_executed_in_order_from_a_clean_kernel_without_errors(path):
    notebook = read_notebook(path)
    cells = code_cells(notebook)
    assert [cell["execution_count"] for cell in cells] == list(range(1, len(cells) + 1))
    assert not [output for output in outputs(notebook) if output["output_type"] == "error"]
    assert not [output for output in outputs(notebook) if output.get("name") == "stderr"]


@EVERY
def test_nothing_of_the_run_or_the_machine_is_kept(path):
    notebook = read_notebook(path)
    text = json.dumps(notebook)
    assert path.stat().st_size < LARGEST_FILE
    assert "widgets" not in notebook["metadata"]
    assert "application/vnd.jupyter.widget-view+json" not in text
    without_pictures = json.dumps([[cell["source"], texts(cell)] for cell in code_cells(notebook)])
    assert not PLACES_ON_A_MACHINE.search(without_pictures)


def texts(cell):
    return [
        [
            output.get("text"),
            output.get("data", {}).get("text/plain"),
            output.get("data", {}).get("text/html"),
        ]
        for output in cell["outputs"]
        if "audio" not in json.dumps(output.get("data", {}).get("text/html", ""))
    ]


@EVERY
def test_cells_are_short(path):
    for cell in code_cells(read_notebook(path)):
        assert len(source(cell).strip().splitlines()) <= LONGEST_CELL, source(cell)


@EVERY
def test_pictures_come_from_the_lab_alone(path):
    for cell in code_cells(read_notebook(path)):
        packages = {
            name.split(".")[0]
            for node in ast.walk(ast.parse(source(cell)))
            if isinstance(node, (ast.Import, ast.ImportFrom))
            for name in ([node.module] if isinstance(node, ast.ImportFrom) else [a.name for a in node.names])
        }
        assert not packages & {"matplotlib", "ipywidgets", "pylab"}, source(cell)


@EVERY
def test_every_picture_says_in_words_what_it_shows(path):
    for output in outputs(read_notebook(path)):
        data = output.get("data", {})
        if "image/png" in data:
            sentence = "".join(data["text/plain"])
            assert output["metadata"]["image/png"]["alt"] == sentence
            assert len(sentence) > 20 and sentence.rstrip().endswith("."), sentence


@CHAPTER
def test_chapter_opens_with_title_objectives_and_time(path):
    found, text = headings(read_notebook(path))
    assert found[0].startswith(path.stem[:2] + " ")
    assert "What you will be able to do" in found
    assert "**Time" in text and "**Before you start" in text


@COURSE
def test_chapter_follows_the_anatomy_of_the_course(path):
    found, text = headings(read_notebook(path))
    for heading in ("What the paper says, what we measure", "Beyond the paper", "Exercises", "References"):
        assert heading in found, f"{path.stem} has no section {heading!r}"
    for lead in ("**Predict", "**Explore", "**Explain"):
        assert text.count(lead) >= 2, f"{path.stem} has fewer than two {lead}**"


@COURSE
def test_chapter_has_three_exercises_that_wait_for_an_answer(path):
    said = json.dumps([cell["outputs"] for cell in code_cells(read_notebook(path))])
    assert said.count("not answered yet") >= 3


@COURSE
def test_chapter_gives_a_verdict_on_each_claim(path):
    said = json.dumps([cell["outputs"] for cell in code_cells(read_notebook(path))])
    assert (
        said.count("<b>holds</b>")
        + said.count("<b>holds with conditions</b>")
        + said.count("<b>does not hold</b>")
        >= 3
    )


@COURSE
def test_chapter_has_sliders(path):
    assert sum(source(cell).count("Lab(") for cell in code_cells(read_notebook(path))) >= 2


@COURSE
def test_every_lab_is_announced_by_a_question_or_a_task(path):
    text = ""
    for cell in read_notebook(path)["cells"]:
        if cell["cell_type"] == "markdown":
            text += source(cell) + "\n"
        elif "Lab(" in source(cell):
            assert re.search(r"\*\*(Predict|Explore)|^1\. ", text, re.MULTILINE), source(cell)
            text = ""


@CHAPTER
def test_solutions_stand_beside_the_exercises(path):
    if "labsim.exercises" not in path.read_text(encoding="utf-8"):
        pytest.skip("no exercises")
    notebook = read_notebook(path.parent / "solutions" / f"{path.stem}_solutions.ipynb")
    assert "assert" in "".join(source(cell) for cell in code_cells(notebook))


def test_start_notebook_leads_to_every_chapter_by_its_title_and_time():
    _, text = headings(read_notebook(CHAPTERS[0]))
    listed = re.findall(r"\| \[(.+?)\]\((\d\d_\w+\.ipynb)\) \|.*\| (\d+)&nbsp;min", text)
    for (title, name, minutes), path in zip(listed, CHAPTERS[1:], strict=True):
        found, chapter = headings(read_notebook(path))
        time = re.search(r"\*\*Time:\*\* (\d+) minutes", chapter)
        assert (title, name, minutes) == (found[0], path.name, time[1])


@pytest.mark.parametrize("path", [*CHAPTERS, *SOLUTIONS, ROOT / "README.md"], ids=lambda path: path.stem)
def test_links_lead_somewhere(path):
    text = path.read_text(encoding="utf-8") if path.suffix == ".md" else headings(read_notebook(path))[1]
    for link in re.findall(r"\]\((?!\w+:)([^)#\s]+)", text):
        assert (path.parent / link).exists(), link
