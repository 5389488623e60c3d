"""A visitor's way through the slider pages: Voilà in a real browser, as `python3 -m labsim apps` starts it.

Needs Voilà and Chromium or Chrome. Where one is missing the tests are skipped, but on CI they fail.
"""

import os
import sys
from importlib.util import find_spec

import pytest
from conftest import CHAPTERS
from servers import serve
from test_browser import WATCH, browser  # noqa: F401 (browser is a fixture)

from labsim.__main__ import apps_command

CODE = ".jp-InputArea-editor:visible, .jp-CodeCell .jp-Cell-inputWrapper:visible"
PAGES = ("01_signal_model", "10_your_own_data")


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    """Voilà as the launcher starts it; yields its address."""
    if find_spec("voila") is None and not os.environ.get("CI"):
        pytest.skip("Voilà is not installed; python3 -m labsim apps installs it")

    def command(port):
        return [*apps_command(sys.executable), "--no-browser", f"--port={port}", "--Voila.ip=127.0.0.1"]

    with serve(command, tmp_path_factory.mktemp("apps"), "/") as (address, _):
        yield address


@pytest.fixture
def page(browser, server):  # noqa: F811
    context = browser.new_context(viewport={"width": 1280, "height": 900}, base_url=server)
    yield context.new_page()
    context.close()


def test_front_page_lists_every_chapter(page):
    page.goto("/")
    names = page.locator("a[href*='.ipynb']").all_inner_texts()
    assert [name.strip() for name in names] == [path.name for path in CHAPTERS]


@pytest.mark.parametrize("name", PAGES)
def test_page_shows_sliders_and_no_code(page, name):
    page.goto(f"/voila/render/{name}.ipynb", timeout=120_000)
    page.locator("h1").first.wait_for(timeout=120_000)
    image = page.locator("img.widget-image").first
    image.wait_for(timeout=120_000)
    assert page.locator("h1").first.inner_text().startswith(name[:2] + " ")
    assert page.locator(".jp-CodeCell").count() > 0
    assert page.locator(CODE).count() == 0
    assert page.locator("[data-mime-type*=stderr], [data-mime-type*=error]").count() == 0
    handle = page.locator(".noUi-handle").first
    handle.focus()
    watched = image.evaluate_handle(f"image => ({{promise: ({WATCH})(image)}})")
    handle.press("ArrowRight")
    assert watched.evaluate("watch => watch.promise") is not None
