# SPDX-License-Identifier: Apache-2.0
"""Fixtures: a headless browser and projects to open in it.  For every page they check that no request leaves this
computer and that no error goes unnoticed."""

from __future__ import annotations

import secrets
import shutil
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partialmethod
from pathlib import Path
from typing import Any

import pytest

from tests.doubles.toolchain import Missing
from tests.live.witness import build_robot
from tests.waiting import PATIENCE

from .firefox import Firefox
from .served import ROOT, Served
from .way import Way

FLAGS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--disable-extensions", "--no-proxy-server",
    "--disable-dev-shm-usage",
]  # fmt: skip
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


def _text_to_see(page: Any, everywhere: Callable[..., Any], text: Any, **how: Any) -> Any:
    """The elements of a page with a text, but not the copy of it that screen readers announce a moment later."""
    return everywhere(page, text, **how).and_(page.locator(":not(#said)"))


@contextmanager
def chromium() -> Iterator[Callable[[], Any]]:
    """Starts a browser.  Raises Missing."""
    try:
        from playwright.sync_api import Page, sync_playwright
    except ImportError:
        raise Missing("playwright is not installed: pip install playwright") from None
    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        raise Missing("Chromium is not installed: sudo apt install chromium")
    with sync_playwright() as playwright, pytest.MonkeyPatch.context() as patch:
        patch.setattr(Page, "get_by_text", partialmethod(_text_to_see, Page.get_by_text))
        yield lambda: playwright.chromium.launch(executable_path=program, args=FLAGS)


@pytest.fixture(scope="session")
def launch() -> Iterator[Callable[[], Any]]:
    with ExitStack() as stack:
        try:
            found = stack.enter_context(chromium())
        except Missing as problem:
            pytest.skip(str(problem))
        yield found


@pytest.fixture(scope="session")
def browser(launch: Callable[[], Any]) -> Iterator[Any]:
    browser = launch()
    yield browser
    browser.close()


@contextmanager
def pages_of(browser: Any) -> Iterator[Callable[..., Any]]:
    """Opens an address in its own browser context; the arguments are Playwright's for a context."""
    contexts: list[Any] = []
    wrong: list[str] = []

    def hear(message: Any) -> None:
        # A refused action is a normal answer; if a file of the page is missing, the check of responses finds it.
        if message.type in ("error", "warning") and not message.text.startswith("Failed to load resource"):
            wrong.append(message.text)

    def see(response: Any) -> None:
        if response.status >= 400 and response.request.method == "GET":
            wrong.append(f"{response.status} {response.url}")

    def leave(request: Any) -> None:
        if not request.url.startswith(("http://127.0.0.1:", "blob:http://127.0.0.1:", "data:")):
            wrong.append(f"a request to {request.url}")

    def make(address: str, **arguments: Any) -> Any:
        settings = {"viewport": {"width": 1280, "height": 800}, "reduced_motion": "reduce", **arguments}
        context = browser.new_context(**settings)
        context.set_default_timeout(1000 * PATIENCE)
        contexts.append(context)
        page = context.new_page()
        page.on("console", hear)
        page.on("response", see)
        page.on("request", leave)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.goto(address)
        page.locator("#header .brand").wait_for()
        return page

    yield make
    for context in contexts:
        context.close()
    assert wrong == []


@pytest.fixture
def open_page(browser: Any) -> Iterator[Callable[..., Any]]:
    with pages_of(browser) as found:
        yield found


class Project:
    """A served copy of examples/jiwy, for the host, with every port connected."""

    def __init__(self, folder: Path) -> None:
        copy_jiwy(folder)
        self.folder = folder
        self.epg = Served(folder)

    @property
    def address(self) -> str:
        return self.epg.address

    @property
    def file(self) -> Path:
        return self.folder / "jiwy.bindings.yaml"

    def text(self) -> str:
        return self.file.read_text(encoding="utf-8")

    def write(self, *replacements: tuple[str, str]) -> str:
        """Writes the example's bindings with these replacements, as the initial state of a test."""
        text = (ROOT / "examples/jiwy/jiwy.bindings.yaml").read_text(encoding="utf-8")
        for old, new in replacements:
            assert old in text, old
            text = text.replace(old, new)
        self.file.write_text(text, encoding="utf-8")
        self.epg.post("reload")
        return text


def copy_jiwy(folder: Path) -> None:
    shutil.copytree(ROOT / "examples/jiwy", folder, ignore=shutil.ignore_patterns("build"))
    cmake = folder / "CMakeLists.txt"
    text = cmake.read_text(encoding="utf-8")
    here = "${CMAKE_CURRENT_SOURCE_DIR}/../.."
    assert here in text
    cmake.write_text(text.replace(here, ROOT.as_posix()), encoding="utf-8")


@pytest.fixture(scope="module")  # a build that one file leaves in the folder is no part of another file's tests
def served_jiwy(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Project]:
    # A new folder each time, in which the user has not yet agreed to build, even if the names of folders repeat.
    project = Project(tmp_path_factory.mktemp(f"connect-{secrets.token_hex(4)}") / "jiwy")
    yield project
    project.epg.end()


@pytest.fixture
def jiwy(served_jiwy: Project) -> Project:
    """The project with the example's own bindings and no unsaved change."""
    served_jiwy.write()
    return served_jiwy


@pytest.fixture
def model(tmp_path: Path) -> Path:
    """A model without a project, as 20-sim writes it."""
    return Path(shutil.copytree(ROOT / "examples/jiwy/model", tmp_path / f"exports-{secrets.token_hex(4)}" / "camera"))


@pytest.fixture
def started(browser: Any, model: Path) -> Iterator[Served]:
    """The start page for that model."""
    with Served(model) as served:
        yield served


@pytest.fixture(scope="session")
def robot_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program of a robot whose actuator notes when it was driven."""
    return build_robot(tmp_path_factory.mktemp("robot"))


@pytest.fixture
def way(robot_program: Path, tmp_path: Path, launch: Callable[[], Any]) -> Iterator[Way]:
    """A page that is not yet connected with a robot, and all that is between them."""
    found = Way(robot_program, tmp_path, launch)
    yield found
    found.close()


@pytest.fixture(scope="session")
def started_firefox() -> Iterator[Firefox]:
    try:
        firefox = Firefox()
    except Missing as problem:
        pytest.skip(str(problem))
    with firefox:
        yield firefox


@pytest.fixture
def firefox(started_firefox: Firefox) -> Iterator[Firefox]:
    started_firefox.resize(1280, 800)
    yield started_firefox
    assert started_firefox.complaints() == []
