# SPDX-License-Identifier: Apache-2.0
"""axe-core, the usual checker of web pages' accessibility: installed once into EPG's cache, as rp2040js is."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.emulator.toolchain import npm_package

HERE = Path(__file__).resolve().parent


def axe_core() -> Path:
    """Its one file.  Raises Missing."""
    return npm_package(HERE, "axe-core") / "axe.min.js"


def violations(page: Any) -> list[str]:
    """What axe-core finds wrong with a page as it is now, in light and in dark, a line per place.

    The script is run by the debugger's protocol: the page's policy would refuse a <script>.
    """
    if not page.evaluate("'axe' in window"):
        page.evaluate(axe_core().read_text(encoding="utf-8"))
    found = []
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        # Colours are all that differs in the dark.
        rules = "" if scheme == "light" else ", runOnly: {type: 'rule', values: ['color-contrast']}"
        result = page.evaluate(f"axe.run(document, {{resultTypes: ['violations']{rules}}})")
        found += [
            f"{scheme}: {rule['id']}: {rule['help']}: {' '.join(map(str, node['target']))}: {node['failureSummary']}"
            for rule in result["violations"]
            for node in rule["nodes"]
        ]
    return found
