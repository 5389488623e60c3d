"""A reader's way through a chapter: JupyterLab in a real browser, a slider moved by its arrow keys.

Needs Chromium or Chrome. Where none is installed the tests are skipped, but on CI they fail.
"""

import os
import shutil
import socket
import statistics
import subprocess
import sys
import time
import urllib.request

import pytest
from conftest import CHAPTERS, ROOT

from labsim.__main__ import lab_command

STEPS = 40
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
# Resolves with the time from the key press until the new picture is decoded, or null after a second.
WATCH = """image => new Promise(resolve => {
    const pressed = performance.now(), before = image.src;
    const stop = setTimeout(() => { watcher.disconnect(); resolve(null) }, 1000);
    const watcher = new MutationObserver(async () => {
        if (image.src === before) return;
        watcher.disconnect();
        clearTimeout(stop);
        await image.decode();
        resolve(performance.now() - pressed);
    });
    watcher.observe(image, {attributes: true, attributeFilter: ['src']});
})"""


@pytest.fixture(scope="module")
def browser():
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None and not os.environ.get("CI"):
        pytest.skip("no Chromium found; install it to run the browser tests")
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield opened
        opened.close()


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """JupyterLab as the launcher starts it, on a copy of the notebooks; yields its address."""
    home = tmp_path_factory.mktemp("lab")
    shutil.copytree(
        ROOT / "notebooks", home / "notebooks", ignore=shutil.ignore_patterns(".ipynb_checkpoints")
    )
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    options = ["--no-browser", "--allow-root", f"--port={port}", "--IdentityProvider.token="]
    command = [*lab_command(sys.executable), *options]
    settings = {f"JUPYTER_{name}_DIR": str(home / name) for name in ("CONFIG", "DATA", "RUNTIME")}
    settings["JUPYTERLAB_WORKSPACES_DIR"] = str(home / "workspaces")
    with open(home / "log", "w") as log:
        process = subprocess.Popen(command, cwd=home, stdout=log, stderr=log, env={**os.environ, **settings})
    address = f"http://127.0.0.1:{port}"
    try:
        wait_for(f"{address}/api", process, home / "log")
        yield address
    finally:
        process.terminate()
        process.wait(30)


def wait_for(address, process, log, seconds=60):
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and process.poll() is None:
        try:
            return urllib.request.urlopen(address, timeout=5)
        except OSError:
            time.sleep(0.2)
    raise RuntimeError(f"JupyterLab did not start: {log.read_text()[-2000:]}")


@pytest.fixture
def page(browser, server):
    context = browser.new_context(viewport={"width": 1280, "height": 900}, base_url=server)
    yield context.new_page()
    context.close()


def run_chapter(page, path):
    """Open a notebook, run all its cells, and wait until the kernel rests."""
    page.goto(f"/lab/tree/notebooks/{path.name}?reset")
    page.locator(".jp-NotebookPanel .jp-Cell").first.wait_for(timeout=60_000)
    page.locator(".jp-NotebookPanel [data-status=idle]").first.wait_for(timeout=60_000)
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
    page.wait_for_timeout(500)
    page.locator(".jp-NotebookPanel [data-status=idle]").first.wait_for(timeout=120_000)


def first_lab(page):
    """The first Lab of the open notebook, found by scrolling down as a reader does."""
    scroller = page.locator(".jp-NotebookPanel .jp-WindowedPanel-outer").first
    lab = page.locator(".jp-OutputArea-output:has(.widget-image)").first
    for screen in range(60):
        scroller.evaluate("(element, top) => { element.scrollTop = top }", 400 * screen)
        page.wait_for_timeout(100)
        if lab.count():
            lab.scroll_into_view_if_needed()
            return lab
    raise AssertionError("no Lab found in the notebook")


def test_start_page_opens_by_itself(page):
    page.goto("/")
    page.locator(".jp-NotebookPanel h1", has_text="00 Start here").wait_for(timeout=60_000)


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem)
def test_slider_changes_the_picture_at_every_step(page, path):
    run_chapter(page, path)
    assert (
        page.locator(
            ".jp-NotebookPanel [data-mime-type*=stderr], .jp-RenderedText[data-mime-type*=error]"
        ).count()
        == 0
    )
    lab = first_lab(page)
    for width in (1920, 1536, 1280):
        page.set_viewport_size({"width": width, "height": 900})
        tracks = [track.bounding_box()["width"] for track in lab.locator(".noUi-base").all()]
        assert min(tracks) >= 120, f"a slider's track is {min(tracks):.0f} px wide on a screen of {width} px"
    image, handle = lab.locator("img.widget-image"), lab.locator(".noUi-handle").first
    handle.focus()
    delays = []
    for step in range(STEPS):
        watched = image.evaluate_handle(f"image => ({{promise: ({WATCH})(image)}})")
        handle.press("ArrowRight" if step % 4 < 2 else "ArrowLeft")
        delays.append(watched.evaluate("watch => watch.promise"))
    missed = delays.count(None)
    median = statistics.median(delay for delay in delays if delay is not None)
    print(f"\n{path.stem}: {STEPS} steps, {missed} missed, median {median:.0f} ms")
    assert missed == 0
