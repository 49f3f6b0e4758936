# SPDX-License-Identifier: Apache-2.0
"""Firefox without a window.  Puppeteer drives it over WebDriver BiDi; ``firefox.mjs`` is the program that does so.

>>> # with Firefox() as firefox: firefox.open(epg.address); firefox.click("#tab-changes")
"""

from __future__ import annotations

import contextlib
import json
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.doubles.toolchain import Missing, node, npm_package
from tests.waiting import PATIENCE, until

from .axe import HERE

NAMES = ("firefox-esr", "firefox")


class Firefox:
    """Tabs of Firefox; all methods are for the one in front.

    Elements are named by selectors of CSS and of Puppeteer: ``::-p-aria(NAME)``, ``HOST >>> IN_ITS_SHADOW``.
    """

    def __init__(self) -> None:
        """Raises Missing."""
        program = next(filter(None, map(shutil.which, NAMES)), None)
        if program is None:
            raise Missing("Firefox is not installed: sudo apt install firefox-esr")
        command = [node(), str(HERE / "firefox.mjs"), program, str(npm_package(HERE, "puppeteer-core"))]
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8"
        )

    def __enter__(self) -> Firefox:
        return self

    def __exit__(self, *_: object) -> None:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()  # then the program closes Firefox
        self._process.wait(20)
        self._process.stdout.close()

    def _do(self, act: str, *arguments: object) -> Any:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(json.dumps([act, *arguments]) + "\n")
        self._process.stdin.flush()
        answer = json.loads(self._process.stdout.readline())
        assert "error" not in answer, f"{act} {arguments}: {answer['error']}"
        return answer["value"]

    def open(self, address: str) -> None:
        self._do("open", address)
        self.until("document.querySelector('#header .brand')")

    def evaluate(self, expression: str) -> Any:
        return self._do("evaluate", expression)

    def new_tab(self) -> None:
        self._do("newTab")

    def show_tab(self, number: int) -> None:
        self._do("showTab", number)

    def close_tab(self) -> None:
        """Closes the newest tab."""
        self._do("closeTab")

    def hold(self, selector: str, seconds: float) -> None:
        """Holds the mouse button over an element."""
        self._do("hold", selector, 1000 * seconds)

    def click(self, selector: str) -> None:
        self._do("click", selector)

    def drag(self, start: str, end: str) -> None:
        self._do("drag", start, end)

    def focus(self, selector: str) -> None:
        self._do("focus", selector)

    def press(self, *keys: str, delay: float = 0.0) -> None:
        """Presses keys, each for ``delay`` ms."""
        for key in keys:
            self._do("press", key, delay)

    def down(self, key: str) -> None:
        self._do("down", key)

    def up(self, key: str) -> None:
        self._do("up", key)

    def type(self, text: str) -> None:
        self._do("type", text)

    @property
    def process(self) -> int:
        """The number of the process that has started the browser."""
        return self._process.pid

    @contextlib.contextmanager
    def left_alone(self) -> Iterator[None]:
        """Nobody drives Firefox meanwhile: it keeps a record of each request for a program that does."""
        self._do("leave")
        try:
            yield
        finally:
            self._do("comeBack")

    def resize(self, width: int, height: int) -> None:
        self._do("resize", width, height)

    def screenshot(self, file: Path) -> None:
        self._do("screenshot", str(file))

    def follow(self, link: str, expression: str) -> Any:
        """The first value of ``expression`` that is true, in the tab that ``link`` opens; the tab is closed."""
        return self._do("follow", link, expression)

    def complaints(self) -> list[str]:
        """The errors and warnings since the last call."""
        found: list[str] = self._do("complaints")
        return found

    def until(self, expression: str, seconds: float = PATIENCE) -> None:
        until(lambda: self.evaluate(f"Boolean({expression})"), expression, seconds, pause=0.05)
