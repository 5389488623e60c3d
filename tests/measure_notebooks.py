"""Measure what one student needs: time, processor seconds and peak memory of each notebook, run once through.

Use: python tests/measure_notebooks.py [NOTEBOOK ...]   (all chapters where none is named)
     python tests/measure_notebooks.py --write          also puts the table into notebooks/README.md
Memory is the largest resident set of the kernel's process and of the workers that it started, which counts
the libraries that it shares with the kernels of others; the server's own share is in the last line. Run it on
a machine that does nothing else.
"""

import platform
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

import nbformat
import psutil
from nbclient import NotebookClient
from servers import serve

from labsim.__main__ import lab_command

ROOT = Path(__file__).parents[1]
README = ROOT / "notebooks" / "README.md"
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"
PERIOD = 0.05
HEAD = (
    "| notebook | seconds | processor seconds | peak memory (MB) | file (kB) |",
    "|---|---:|---:|---:|---:|",
)


def measure(path):
    """Run a notebook in its own kernel; returns (seconds, processor seconds, peak memory in MB)."""
    notebook = nbformat.read(path, as_version=4)
    client = NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(path.parent)}})
    with client.setup_kernel():
        kernel = psutil.Process(client.km.provisioner.pid)
        peak = Peak(kernel)
        begin = time.monotonic()
        for index, cell in enumerate(notebook.cells):
            client.execute_cell(cell, index)
        seconds = time.monotonic() - begin
        used = sum(sum(process.cpu_times()[:2]) for process in family(kernel))
        return seconds, used, peak.stop() / 1e6


def family(process):
    """A process and the workers that it started."""
    return [process, *process.children(recursive=True)]


class Peak:
    """The largest resident memory of a process and its workers until stop(), bytes, looked at every 50 ms."""

    def __init__(self, process):
        self.process, self.largest, self.done = process, 0, threading.Event()
        self.thread = threading.Thread(target=self.watch, daemon=True)
        self.thread.start()

    def watch(self):
        while not self.done.wait(PERIOD):
            with suppress(psutil.NoSuchProcess):  # a worker that has just ended
                self.largest = max(self.largest, sum(one.memory_info().rss for one in family(self.process)))

    def stop(self):
        self.done.set()
        self.thread.join()
        return self.largest


def server_memory():
    """Resident memory of a JupyterLab server that has just started, MB."""

    def command(port):
        options = ["--no-browser", "--allow-root", "--IdentityProvider.token=", f"--port={port}"]
        return [*lab_command(sys.executable), *options]

    with tempfile.TemporaryDirectory() as home, serve(command, home, "/lab") as (_, process):
        return psutil.Process(process.pid).memory_info().rss / 1e6


def table(paths):
    """The lines of the table, one notebook after the other."""
    yield from HEAD
    for path in paths:
        seconds, used, memory = measure(path)
        size = path.stat().st_size / 1e3
        yield f"| {path.stem} | {seconds:.0f} | {used:.0f} | {10 * round(memory / 10)} | {size:.0f} |"
    yield f"| the JupyterLab server beside them | | | {10 * round(server_memory() / 10)} | |"
    machine = f"{psutil.cpu_count()} cores ({platform.machine()}), Python {platform.python_version()}"
    yield ""
    yield f"Measured by `tests/measure_notebooks.py` on {machine}."


def put_into_readme(lines):
    before, _, rest = README.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    README.write_text(
        "\n".join([before + BEGIN, "", *lines, "", END + after]), encoding="utf-8", newline="\n"
    )


if __name__ == "__main__":
    named = [Path(name).resolve() for name in sys.argv[1:] if name != "--write"]
    lines = []
    for line in table(named or sorted((ROOT / "notebooks").glob("*.ipynb"))):
        print(line, flush=True)
        lines.append(line)
    if "--write" in sys.argv[1:]:
        put_into_readme(lines)
