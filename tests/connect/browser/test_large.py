# SPDX-License-Identifier: Apache-2.0
"""A model with 60 ports and a target with 80: the page shows everything, and is fast enough for a drag."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.connect.robots import write_model

from .acts import field, handle, until
from .served import Served

Open = Callable[..., Any]
PORTS, COMPONENTS = 30, 40  # in each direction
SIDES = {"in": "{}", "out": "0.0"}

BOTTOM = "(({scrollTop: y, clientHeight: h, scrollHeight: all}) => y + h > all - 2)(document.getElementById('main'))"


@pytest.fixture
def large(browser: Any, tmp_path: Path) -> Iterator[Served]:
    inputs, outputs = (dict.fromkeys((f"{side}_{n}" for n in range(PORTS)), value) for side, value in SIDES.items())
    model = write_model(tmp_path / "model", "large", inputs, outputs)
    components = "".join(
        f"  command_{n}: {{kind: ros_subscriber, topic: command_{n}, unit: rad}}\n"
        f"  value_{n}: {{kind: ros_publisher, topic: value_{n}}}\n"
        for n in range(COMPONENTS)
    )
    (tmp_path / "large.tcf").write_text(
        f"version: 1\ntarget: host\nnode: large\ncontrol: {{enable_at_start: true}}\ncomponents:\n{components}",
        encoding="utf-8",
    )
    wires = {
        "inputs": "".join(f"  in_{n}: command_{n}\n" for n in range(PORTS)),
        "outputs": "".join(f"  out_{n}: value_{n}\n" for n in range(PORTS - 1)),
    }
    bindings = tmp_path / "large.bindings.yaml"
    bindings.write_text(
        f"version: 1\nmodel: model\ninputs:\n{wires['inputs']}outputs:\n{wires['outputs']}", encoding="utf-8"
    )
    with Served("--tcf", tmp_path / "large.tcf", "--model", model, "--bindings", bindings) as served:
        yield served


def test_large_model(large: Served, open_page: Open) -> None:
    page = open_page(large.address)
    page.locator(".wire-group").nth(2 * PORTS - 2).wait_for()
    assert page.locator(".ports .port").count() == 2 * PORTS
    assert page.locator(".component .port").count() == 2 * COMPONENTS

    # Every move of a dragged end draws every wire; every new state draws the whole page.  Other programs make both
    # times longer.
    draw, copy = page.evaluate(
        "(async () => { const { draw } = await import(new URL('ui.js', location)); draw();"
        " const shortest = (act) => Math.min(...Array.from({ length: 9 }, () => {"
        # the time that a user sees
        " const start = performance.now(); act(); return performance.now() - start; }));"
        " return [shortest(draw), shortest(() => document.body.cloneNode(true))]; })()"
    )
    assert draw < 4 * copy, f"{draw:.1f} ms for drawing the page, {copy:.1f} ms for a copy of its elements"

    # Ports out of sight can be reached: the diagram scrolls while an end is held at its edge.
    last = f"out_{PORTS - 1}"
    start, end = handle(page, "outputs", last), handle(page, "sinks", f"value_{COMPONENTS - 1}")
    start.scroll_into_view_if_needed()
    box, main = start.bounding_box(), page.locator("#main").bounding_box()
    page.mouse.move(box["x"] + 7, box["y"] + 7)
    page.mouse.down()
    page.mouse.move(box["x"] + 100, main["y"] + main["height"] - 5, steps=3)
    until(page, BOTTOM, 20)
    box = end.bounding_box()
    page.mouse.move(box["x"] + 7, box["y"] + 7)
    page.mouse.up()
    until(page, f"document.getElementById('ends-{last}-0').value === ':value_{COMPONENTS - 1}'")
    field(page, last).select_option("")
    page.get_by_text(f"model output '{last}' is not bound").first.wait_for()
    page.locator("#main").evaluate("(main) => { main.scrollTop = 0; }")
    page.locator(".problem-list").get_by_text(f"model output '{last}' is not bound", exact=True).click()
    assert page.evaluate("document.activeElement.id") == f"ends-{last}-0"
    assert field(page, last).evaluate("(field) => field.getBoundingClientRect().bottom < innerHeight")
