# SPDX-License-Identifier: Apache-2.0
"""A page that is used by keys alone, in Chromium or in Firefox.

>>> # keys = Keys(ChromiumKeys(page)); keys.press("Tab"); keys.walk()
"""

from __future__ import annotations

from typing import Any, Protocol

from tests.waiting import until

FIND = """(() => {
  const all = document.querySelectorAll("a[href], button, input, select, textarea, summary, [tabindex]");
  const reached = (each) => each.tabIndex >= 0 && !each.matches(":disabled, [aria-disabled=true], [inert] *")
    && each.checkVisibility({ visibilityProperty: true });
  globalThis.stops = [...all].filter(reached);
  globalThis.stops[0].focus();
  return globalThis.stops.length;
})()"""
"""Finds the elements that Tab must reach, in their order, and focuses the first one."""
LATER = """(() => {
  const wanted = [...document.querySelectorAll("a, button, input, select, textarea, summary, [tabindex]")]
    .find((it) => Boolean(%s));
  const here = document.activeElement;
  return !wanted || here.contains(wanted) || Boolean(here.compareDocumentPosition(wanted) & 4);
})()"""
"""True if an element is behind the one that has the focus."""
HERE = """(() => {
  const it = document.activeElement;
  const { left, top, width, height } = it.getBoundingClientRect();
  const above = document.elementFromPoint(left + Math.min(width / 2, innerWidth / 2), top + Math.min(height / 2, 20));
  const scrolls = it.scrollHeight > it.clientHeight || it.scrollWidth > it.clientWidth;
  return {
    number: globalThis.stops.indexOf(it),
    name: `${it.localName}#${it.id}.${it.className} ${(it.ariaLabel ?? it.textContent).slice(0, 30)}`,
    scrolls,
    place: [left, top, width, height, innerHeight, above?.outerHTML.slice(0, 80)].join(),
    covered: !(above === it || it.contains(above) || above?.contains(it) || it.labels?.[0]?.contains(above)),
  };
})()"""


class Browser(Protocol):
    def evaluate(self, expression: str) -> Any: ...
    def press(self, key: str, *, delay: float = 0.0) -> None: ...
    def down(self, key: str) -> None: ...
    def up(self, key: str) -> None: ...
    def type(self, text: str) -> None: ...
    def open(self, address: str) -> None: ...
    def resize(self, width: int, height: int) -> None: ...


class Chromium:
    """A page of Playwright with the methods of :class:`tests.connect.browser.firefox.Firefox`."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.evaluate = page.evaluate
        self.press, self.down, self.up = page.keyboard.press, page.keyboard.down, page.keyboard.up
        self.type = page.keyboard.type

    def open(self, address: str) -> None:
        self.page.goto(address)
        self.page.locator("#header .brand").wait_for()

    def resize(self, width: int, height: int) -> None:
        self.page.set_viewport_size({"width": width, "height": height})


class Keys:
    """The keyboard of a browser, and expressions of JavaScript about its page; ``it`` is the element with the focus."""

    def __init__(self, browser: Browser) -> None:
        self.browser = browser
        self.evaluate, self.type = browser.evaluate, browser.type

    def press(self, *keys: str) -> None:
        for key in keys:
            self.browser.press(key)

    def back(self) -> None:
        """Presses Shift-Tab."""
        self.browser.down("Shift")
        self.browser.press("Tab")
        self.browser.up("Shift")

    def hold(self, key: str, seconds: float) -> None:
        self.browser.press(key, delay=1000 * seconds)

    def it(self, expression: str) -> Any:
        return self.evaluate(f"(() => {{ const it = document.activeElement; return {expression}; }})()")

    def until(self, expression: str) -> None:
        """Waits until an expression is true."""
        until(lambda: self.evaluate(f"Boolean({expression})"), expression, pause=0.05)

    def tab_to(self, condition: str) -> None:
        """Presses Tab, or Shift-Tab, until a condition is true of ``it``.  The focus never leaves the page: a window of
        Firefox without a screen is not active any more after that."""
        later = self.evaluate(LATER % condition)
        for _ in range(200):
            self.press("Tab") if later else self.back()
            if self.it(f"Boolean({condition})"):
                return
        raise AssertionError(f"Tab does not lead to: {condition}")

    def walk(self) -> None:
        """Goes by Tab from the first element to the last one and back.  Nothing may be left out, or be covered."""
        last = self.evaluate(FIND) - 1
        self._go(list(range(1, last + 1)), self.press, ("Tab",))
        self._go(list(range(last - 1, -1, -1)), self.back, ())

    def _go(self, wanted: list[int], act: Any, arguments: tuple[str, ...]) -> None:
        reached: list[int] = []
        names: list[str] = []
        for _ in range(2 * len(wanted) + 20):
            if reached[-1:] == wanted[-1:]:
                break
            act(*arguments)
            here = self.evaluate(HERE)
            for _ in range(60):  # Firefox scrolls some frames later
                if not here["covered"]:
                    break
                self.evaluate("new Promise((drawn) => requestAnimationFrame(drawn))")
                here = self.evaluate(HERE)
            names.append(here["name"])
            if here["number"] >= 0:
                reached.append(here["number"])
                assert not here["covered"], (names[-1], here["place"])
            else:  # browsers also stop at areas that scroll
                assert here["scrolls"], names[-3:]
        missing = [self.evaluate(f"stops[{number}].outerHTML.slice(0, 99)") for number in {*wanted} - {*reached}]
        assert reached == wanted, (missing, names)
