"""axe-core, the usual checker of web pages' accessibility: installed once into EPG's cache, as rp2040js is."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

from epg.bootstrap import cache_folder
from tests.emulator.toolchain import Missing, locked

HERE = Path(__file__).resolve().parent


def axe_core() -> Path:
    """Its one file.  Raises Missing."""
    version = json.loads((HERE / "package.json").read_text(encoding="utf-8"))["dependencies"]["axe-core"]
    folder = cache_folder() / f"axe-core-{version}"
    script = folder / "node_modules" / "axe-core" / "axe.min.js"
    with locked(folder):
        if not script.is_file():
            _install(folder)
    return script


def _install(folder: Path) -> None:
    npm = shutil.which("npm")
    if npm is None:
        raise Missing("npm is not installed: apt install nodejs npm")
    if os.environ.get("EPG_NO_INSTALL"):
        raise Missing(f"axe-core is not in EPG's cache and EPG_NO_INSTALL is set: npm ci --prefix {folder}")
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "package-lock.json"):
        shutil.copy(HERE / name, folder / name)
    command = [npm, "ci", "--no-audit", "--no-fund", "--ignore-scripts"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = (done.stderr.strip().splitlines() or ["npm has failed"])[-1]
        raise Missing(f"axe-core could not be installed ({said}): npm ci --prefix {folder}")


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
