"""Measure what one student needs: time, processor seconds and peak memory of each notebook, run once through.

Use: python tests/measure_notebooks.py [NOTEBOOK ...]   (all chapters where none is named)
     python tests/measure_notebooks.py --write          also puts the table into notebooks/README.md
Memory is the largest resident set of the kernel's process, which counts the libraries that it shares with
the kernels of others; the server's own share is in the last line. Run it on a machine that does nothing else.
"""

import platform
import socket
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from pathlib import Path

import nbformat
import psutil
from nbclient import NotebookClient

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
        used = sum(kernel.cpu_times()[:2])
        return seconds, used, peak.stop() / 1e6


class Peak:
    """The largest resident memory of a process from now until stop(), bytes, looked at every 50 ms."""

    def __init__(self, process):
        self.process, self.largest, self.done = process, 0, threading.Event()
        self.thread = threading.Thread(target=self.watch, daemon=True)
        self.thread.start()

    def watch(self):
        while not self.done.wait(PERIOD):
            self.largest = max(self.largest, self.process.memory_info().rss)

    def stop(self):
        self.done.set()
        self.thread.join()
        return self.largest


def server_memory():
    """Resident memory of a JupyterLab server that has just started, MB."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", f"--port={port}"]
        server = subprocess.Popen(
            [*command, "--IdentityProvider.token="], cwd=folder, stderr=subprocess.DEVNULL
        )
        try:
            wait_for(f"http://127.0.0.1:{port}/lab")
            return psutil.Process(server.pid).memory_info().rss / 1e6
        finally:
            server.terminate()
            server.wait(30)


def wait_for(address, seconds=60):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        try:
            return urllib.request.urlopen(address, timeout=5).read()
        except OSError:
            time.sleep(0.2)
    raise RuntimeError("JupyterLab did not start")


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
