"""What several tests share: where the notebooks are and what is in them."""

import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
CHAPTERS = sorted((ROOT / "notebooks").glob("*.ipynb"))
SLIDER_TABLE = "from key press to new picture"
SOLUTIONS = sorted((ROOT / "notebooks" / "solutions").glob("*.ipynb"))
PLACES_ON_A_MACHINE = re.compile(
    rf"{re.escape(str(ROOT))}|/(home|root|tmp|Users)/|[A-Z]:\\\\|0x[0-9a-f]{{8}}"
)


def read_notebook(path):
    """The notebook as JSON."""
    return json.loads(path.read_text(encoding="utf-8"))


def source(cell):
    """The text of a cell."""
    return "".join(cell["source"])


def code_cells(notebook):
    """The code cells that hold any code."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code" and source(cell).strip()]


def count_labs(path):
    """How many Labs a notebook shows."""
    return sum(source(cell).count("Lab(") for cell in code_cells(read_notebook(path)))


def pytest_terminal_summary(terminalreporter):
    """Print what the browser test measured, one line for each Lab of the course."""
    ended = [*terminalreporter.getreports("passed"), *terminalreporter.getreports("failed")]
    rows = sorted(row for report in ended for name, row in report.user_properties if name == SLIDER_TABLE)
    if rows:
        terminalreporter.section(f"Slider steps in the browser: {SLIDER_TABLE}")
        terminalreporter.write("\n".join(rows) + "\n")
