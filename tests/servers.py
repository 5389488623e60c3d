"""Start a server of notebooks for a test or a measurement, and stop it."""

import os
import shutil
import socket
import subprocess
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[1]


@contextmanager
def serve(command, home, page):
    """Run a server's command in a folder with a copy of the notebooks; yields its address and its process.

    command : function of a port, which returns the command's words; home : folder for all that is written
    page : answers when the server is ready. Raises RuntimeError when it has not after a minute.
    """
    home = Path(home)
    shutil.copytree(
        ROOT / "notebooks", home / "notebooks", ignore=shutil.ignore_patterns(".ipynb_checkpoints")
    )
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    settings = {f"JUPYTER_{name}_DIR": str(home / name) for name in ("CONFIG", "DATA", "RUNTIME")}
    settings["JUPYTERLAB_WORKSPACES_DIR"] = str(home / "workspaces")
    with open(home / "log", "w") as log:
        process = subprocess.Popen(
            command(port), cwd=home, stdout=log, stderr=log, env={**os.environ, **settings}
        )
    address = f"http://127.0.0.1:{port}"
    try:
        _wait_for(address + page, process, home / "log")
        yield address, process
    finally:
        process.terminate()
        process.wait(30)


def _wait_for(address, process, log, seconds=60):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and process.poll() is None:
        try:
            return urllib.request.urlopen(address, timeout=5).read()
        except OSError:
            time.sleep(0.2)
    raise RuntimeError(f"the server did not start: {log.read_text()[-2000:]}")
