# SPDX-License-Identifier: Apache-2.0
"""``docs/adding-a-platform.md`` lists the variables of templates of platforms, and what ``epg/plant.h`` declares."""

from __future__ import annotations

import re
from typing import Any

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.application import Emitter
from epg.generator.project import Request, load_application
from epg.generator.source import Span
from tests.errors.test_errors import HERE as CASES

ROOT = CASES.parent.parent
PAGE = ROOT / "docs" / "adding-a-platform.md"


@pytest.fixture(scope="module")
def variables() -> dict[str, Any]:
    """The variables of a target with one of each: a tick, claims with alternate functions, outputs."""
    common = CASES / "common"
    wiring = {
        "target": "nucleo_h743zi_zephyr",
        "components.encoder.pins": "{a: PD12, b: PD13}",
        "components.motor.pins": "{value: PE9, direction_a: PE2, direction_b: PE3}",
        "components.button.pins": "{value: PE4}",
    }
    settings = [(f"{key}={value}", Span("test")) for key, value in wiring.items()]
    files = {"model": common / "model", "bindings": common / "bindings.yaml", "beside": common}
    request = Request("robot", "robot.tcf", settings=settings, **files)
    problems = Diagnostics()
    app = load_application(request, problems)
    assert app is not None, [problem.message for problem in problems]
    context = Emitter(app, request.roots)._context()
    claims = {claim.resource_class: claim for claim in context["claims"]}
    context["claim"] = claims["quadrature"]
    context["pwm"] = claims["pwm"]
    context["output"] = context["output_pins"][0]
    context["group"] = context["output_groups"][0]
    context["state"] = context["group"].states[0]
    return context


def expressions() -> list[str]:
    """The expressions in the first column of the tables, and in the text behind them."""
    section = re.search(r"### What templates can print\n(.*?)\n## ", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert section is not None
    first = [line.split(" | ")[0] for line in section[1].splitlines() if line.startswith("| `")]
    text = " ".join([*first, *re.findall(r"`(?:output|group|state)\.[a-z.]+`", section[1])])
    return list(dict.fromkeys(re.findall(r"`([^`]+)`", text)))


def test_the_page_lists_variables() -> None:
    assert len(expressions()) > 30


@pytest.mark.parametrize("expression", expressions())
def test_a_template_can_use_it(expression: str, variables: dict[str, Any]) -> None:
    names = {"claim.settings": "pwm.settings", "claim.clock": "pwm.clock", "claim.frequency": "pwm.frequency"}
    for claimed, pwm in names.items():
        expression = expression.replace(claimed, pwm)
    expression = expression.replace('clocks["timers"]', 'clocks["apb1_timers"]')
    value = eval(expression, {}, variables)
    assert value is not None


def test_the_header_of_plants_is_listed_whole() -> None:
    text = (ROOT / "targets/runtime/include/epg/plant.h").read_text(encoding="utf-8")
    code = re.sub(r" ?/[*].*?[*]/", "", text, flags=re.DOTALL)
    left_out = ('extern "C" {', "}", "")
    lines = [line.rstrip() for line in code.splitlines() if not line.startswith("#") and line.strip() not in left_out]
    assert "\n".join(["```c", *lines, "```"]) in PAGE.read_text(encoding="utf-8")
