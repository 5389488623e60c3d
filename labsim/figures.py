"""Every figure and table of the papers that the notebooks reproduce, written to files.

The notebooks are the only place where these are made: their cells are run here, and what they show
under a name (`still(..., name="paper1_figure4")`, `Table(..., name="paper3_table1")`) is saved, with
the parameters that made it beside it.
"""

import argparse
import ast
import csv
import hashlib
import json
import os
import platform
import re
import sys
import tempfile
from contextlib import redirect_stdout
from dataclasses import is_dataclass
from importlib.metadata import version
from io import StringIO
from pathlib import Path

from labsim.checks import Table
from labsim.lab import Still

ROOT = Path(__file__).parents[1]
NAMED = re.compile(r"""name=["'](paper(\d+)_\w+)["']""")
PACKAGES = ("numpy", "scipy", "matplotlib")


def displayed(path):
    """Run a notebook's code cells, in its folder, and yield each object that a cell shows, but no prints."""
    shown = []
    namespace = {"__name__": "__main__", "display": lambda *objects: shown.extend(objects)}
    folder = os.getcwd()
    os.chdir(path.parent)
    try:
        for source in code(path):
            tree = ast.parse(source)
            last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
            with redirect_stdout(StringIO()):
                exec(compile(tree, path.name, "exec"), namespace)
                if last is not None:
                    shown.append(eval(compile(ast.Expression(last.value), path.name, "eval"), namespace))
            yield from shown
            shown.clear()
    finally:
        os.chdir(folder)


def code(path):
    """The text of each code cell of a notebook."""
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def chapters():
    """The notebooks that reproduce something, each with the names of what it reproduces."""
    found = {
        path: NAMED.findall("\n".join(code(path))) for path in sorted((ROOT / "notebooks").glob("*.ipynb"))
    }
    return {path: names for path, names in found.items() if names}


def save(shown, folder):
    """Write a named picture (SVG, PNG) or table (CSV) and its parameters (JSON); return the files' names."""
    stem = folder / shown.name
    if isinstance(shown, Table):
        with open(stem.with_suffix(".csv"), "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows([shown.head, *shown.rows])
        kinds = ["csv"]
    else:
        shown.figure.savefig(stem.with_suffix(".svg"), metadata={"Date": None})
        shown.figure.savefig(stem.with_suffix(".png"), dpi=200)
        kinds = ["svg", "png"]
    description = {
        "name": shown.name,
        "shows": getattr(shown, "sentence", ""),
        "parameters": plain(shown.parameters),
        "versions": versions(),
    }
    stem.with_suffix(".json").write_text(
        json.dumps(description, indent=1, ensure_ascii=False), encoding="utf-8"
    )
    return [f"{shown.name}.{kind}" for kind in (*kinds, "json")]


def plain(value):
    """A value as JSON can hold it."""
    if is_dataclass(value):
        value = {field: getattr(value, field) for field in value.__dataclass_fields__}
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value if isinstance(value, (int, float, str, bool, type(None))) else type(value).__name__


def versions():
    """What the numbers may depend on."""
    return {"python": platform.python_version(), "labsim": version("labsim")} | {
        p: version(p) for p in PACKAGES
    }


def fingerprint(path):
    """Changes when the notebook, its data, the package or a version changes."""
    files = [path, *sorted(path.parent.glob("data/*.*")), *sorted((ROOT / "labsim").rglob("*.py"))]
    content = b"".join(file.read_bytes() for file in files) + json.dumps(versions()).encode()
    return hashlib.sha256(content).hexdigest()


def unchanged(manifest, mark):
    """True where an earlier run wrote everything and nothing has changed since."""
    try:
        earlier = json.loads(manifest.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return earlier["fingerprint"] == mark and all(
        (manifest.parent / name).exists() for name in earlier["files"]
    )


def write_chapter(path, folder, paper=None):
    """Write what one notebook reproduces; return a word on what was done."""
    mark = fingerprint(path)
    manifest = folder / f".{path.stem}{'' if paper is None else f'_{paper}'}.json"
    if unchanged(manifest, mark):
        return "unchanged"
    files = []
    for shown in displayed(path):
        wanted = getattr(shown, "name", None) and isinstance(shown, (Still, Table))
        if wanted and (paper is None or shown.name.startswith(f"paper{paper}_")):
            files += save(shown, folder)
    manifest.write_text(json.dumps({"fingerprint": mark, "files": files}), encoding="utf-8")
    return f"{len(files)} files"


def main(arguments):
    """Run the command; return its exit status."""
    parser = argparse.ArgumentParser(prog="python3 -m labsim figures", description=__doc__.splitlines()[0])
    parser.add_argument("--paper", type=int, help="only this paper's")
    parser.add_argument(
        "--out", type=Path, default=ROOT / "figures", help="folder to write to (default: figures)"
    )
    chosen = parser.parse_args(arguments)
    papers = sorted({int(number) for names in chapters().values() for _, number in names})
    if chosen.paper is not None and chosen.paper not in papers:
        print(
            f"labsim: --paper must be one of {', '.join(map(str, papers))}, not {chosen.paper}",
            file=sys.stderr,
        )
        return 1
    try:
        chosen.out.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=chosen.out).close()
        for path, names in chapters().items():
            if chosen.paper is None or str(chosen.paper) in {number for _, number in names}:
                print(f"{path.stem} ... ", end="", flush=True)
                print(write_chapter(path, chosen.out.resolve(), chosen.paper), flush=True)
    except OSError as error:
        print(
            f"labsim: cannot write to {chosen.out} ({error.strerror}); choose another with --out",
            file=sys.stderr,
        )
        return 1
    except KeyboardInterrupt:
        print("\nlabsim: stopped; the same command goes on with the next chapter.", file=sys.stderr)
        return 130
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
