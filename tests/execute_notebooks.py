"""Execute notebooks in order from a clean kernel and save them as they are to be committed.

Use: python tests/execute_notebooks.py [NOTEBOOK ...]   (all notebooks where none is named)
Kept: text, tables, and the still pictures of the Labs. Left out: what only a running kernel can
show (widget models), timings, and the version of the Python that ran it.
"""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

ROOT = Path(__file__).parents[1]
WIDGET = "application/vnd.jupyter.widget-view+json"


def execute(path):
    """Run one notebook and write it back; raises on the first cell that fails."""
    notebook = nbformat.read(path, as_version=4)
    resources = {"metadata": {"path": str(path.parent)}}
    NotebookClient(
        notebook, timeout=300, record_timing=False, coalesce_streams=True, resources=resources
    ).execute()
    clean(notebook)
    nbformat.validate(notebook)
    nbformat.write(notebook, path)


def clean(notebook):
    """Remove what belongs to this run alone."""
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    for cell in notebook.cells:
        cell.metadata = {"tags": cell.metadata.tags} if cell.metadata.get("tags") else {}
        for output in cell.get("outputs", []):
            output.get("data", {}).pop(WIDGET, None)


def find_notebooks():
    """Every notebook of the course and its solutions, in reading order."""
    return sorted((ROOT / "notebooks").glob("*.ipynb")) + sorted(
        (ROOT / "notebooks/solutions").glob("*.ipynb")
    )


if __name__ == "__main__":
    for path in [Path(name).resolve() for name in sys.argv[1:]] or find_notebooks():
        print(path.name, flush=True)
        execute(path)
