# SPDX-License-Identifier: Apache-2.0
"""axe-core, a checker of the accessibility of web pages.  It is installed once into EPG's cache, like rp2040js."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.doubles.toolchain import npm_package

HERE = Path(__file__).resolve().parent


def axe_core() -> Path:
    """The single file of axe-core.  Raises Missing."""
    return npm_package(HERE, "axe-core") / "axe.min.js"


def violations(page: Any) -> list[str]:
    """The violations that axe-core finds in the present state of a page, light and dark, one line per place.

    The script runs over the debugger's protocol, because the page's policy would refuse a <script>.
    """
    found = []
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        # Dark mode changes only colours.
        rules = "" if scheme == "light" else "runOnly: {type: 'rule', values: ['color-contrast']}"
        found += [f"{scheme}: {each}" for each in violations_by(page.evaluate, rules)]
    return found


def violations_by(evaluate: Callable[[str], Any], rules: str = "") -> list[str]:
    """The violations in a page in which ``evaluate`` runs JavaScript.  ``rules`` are options of axe-core.

    All rules for WCAG 2.2, levels A and AA, are used: axe-core leaves the one about the size of targets out.
    """
    if not evaluate("'axe' in window"):
        evaluate(axe_core().read_text(encoding="utf-8"))
    options = rules or "rules: {'target-size': {enabled: true}}"
    result = evaluate(f"axe.run(document, {{resultTypes: ['violations'], {options}}})")
    return [
        f"{rule['id']}: {rule['help']}: {' '.join(map(str, node['target']))}: {node['failureSummary']}"
        for rule in result["violations"]
        for node in rule["nodes"]
    ]
