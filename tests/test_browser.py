"""A reader's way through a chapter: JupyterLab in a real browser, a slider moved by its arrow keys.

Needs Chromium or Chrome. Where none is installed the tests are skipped, but on CI they fail.
"""

import os
import shutil
import statistics
import sys

import pytest
from conftest import CHAPTERS, SLIDER_TABLE, count_labs
from servers import serve

from labsim.__main__ import lab_command

STEPS = 40
NARROWEST = 120
WITH_LABS = [path for path in CHAPTERS if count_labs(path)]
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
# Resolves with whether the open notebook ran to its end without an error.
RUN_ALL = """async () => {
    const panel = jupyterapp.shell.currentWidget;
    await panel.context.ready;
    await panel.sessionContext.ready;
    return jupyterapp.commands.execute('notebook:run-all-cells');
}"""
# Resolves with the time from the key press until the new picture is decoded, or null after five seconds.
WATCH = """image => new Promise(resolve => {
    const pressed = performance.now(), before = image.src;
    const stop = setTimeout(() => { watcher.disconnect(); resolve(null) }, 5000);
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
    """JupyterLab as the launcher starts it; yields its address."""
    options = [
        "--no-browser",
        "--allow-root",
        "--IdentityProvider.token=",
        "--LabApp.expose_app_in_browser=True",
    ]

    def command(port):
        return [*lab_command(sys.executable), *options, f"--port={port}"]

    with serve(command, tmp_path_factory.mktemp("lab"), "/api") as (address, _):
        yield address


@pytest.fixture
def page(browser, server):
    context = browser.new_context(viewport={"width": 1280, "height": 900}, base_url=server)
    yield context.new_page()
    context.close()


def run_chapter(page, path):
    """Open a notebook and run all its cells."""
    page.goto(f"/lab/tree/notebooks/{path.name}?reset")
    page.wait_for_function(
        "name => window.jupyterapp?.shell.currentWidget?.context?.path.endsWith(name)",
        arg=path.name,
        timeout=60_000,
    )
    assert page.evaluate(RUN_ALL), "a cell of the notebook failed, or the notebook could not be run"


def labs(page, count):
    """So many Labs of the open notebook, found by scrolling down as a reader does, each brought into view."""
    scroller = page.locator(".jp-NotebookPanel .jp-WindowedPanel-outer").first
    met, top = set(), 0
    while len(met) < count and top <= scroller.evaluate("element => element.scrollHeight"):
        scroller.evaluate("(element, top) => { element.scrollTop = top }", top)
        page.wait_for_timeout(100)
        for cell in page.locator(".jp-NotebookPanel .jp-Cell:has(.widget-image)").all():
            index = cell.get_attribute("data-windowed-list-index")
            if index not in met:
                met.add(index)
                lab = page.locator(f".jp-Cell[data-windowed-list-index='{index}'] .jp-OutputArea-output")
                lab = lab.filter(has=page.locator(".widget-image"))
                lab.scroll_into_view_if_needed()
                yield lab
        top += 500


def require_room(page, lab):
    """Fail where a slider's track is too narrow to use, on a wide, a usual and a small screen."""
    for width in (1920, 1536, 1280):
        page.set_viewport_size({"width": width, "height": 900})
        tracks = [track.bounding_box()["width"] for track in lab.locator(".noUi-base").all()]
        assert min(tracks) >= NARROWEST, f"a track of {min(tracks):.0f} px on a screen of {width} px"


def steps(lab):
    """Press an arrow key on a Lab's first slider 40 times; the delay of each picture in ms, or None."""
    image, handle = lab.locator("img.widget-image"), lab.locator(".noUi-handle").first
    handle.focus()
    keys = ["ArrowRight", "ArrowRight", "ArrowLeft", "ArrowLeft"]
    if handle.get_attribute("aria-valuenow") == handle.get_attribute("aria-valuemax"):
        keys.reverse()
    delays = []
    for step in range(STEPS):
        watched = image.evaluate_handle(f"image => ({{promise: ({WATCH})(image)}})")
        handle.press(keys[step % 4])
        delays.append(watched.evaluate("watch => watch.promise"))
    return delays


def test_start_page_opens_by_itself(page):
    page.goto("/")
    page.locator(".jp-NotebookPanel h1", has_text="00 Start here").wait_for(timeout=60_000)


@pytest.mark.parametrize("path", WITH_LABS, ids=lambda path: path.stem)
def test_every_lab_follows_its_slider(page, path, record_property):
    run_chapter(page, path)
    assert page.locator(".jp-NotebookPanel [data-mime-type*=error]").count() == 0
    missed = []
    for number, lab in enumerate(labs(page, count_labs(path)), 1):
        if number == 1:
            require_room(page, lab)
        delays = steps(lab)
        missed.append(delays.count(None))
        median = statistics.median(delay or 5000.0 for delay in delays)
        row = f"{path.stem:30s} Lab {number}: median {median:4.0f} ms, {missed[-1]} of {STEPS} missed"
        record_property(SLIDER_TABLE, row)
    assert missed == [0] * count_labs(path)
