# SPDX-License-Identifier: Apache-2.0
"""A linter and the TypeScript compiler read the page's scripts.  Real states have the type of the page's state."""

from __future__ import annotations

import hashlib
import json
import secrets
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from epg.connect.session import Session
from tests.connect.page import session_of
from tests.connect.robots import ROOT, one_axis_project
from tests.connect.test_overview import write_pair
from tests.doubles.toolchain import npm_package, skip_if_missing
from tests.waiting import until

from .axe import HERE

PAGE = ROOT / "epg/connect/page"


@pytest.fixture(scope="module", autouse=True)
def _checkers() -> None:
    skip_if_missing(lambda: npm_package(HERE, "typescript"))


def _run(package: str, *arguments: str | Path) -> str:
    """The complaints of a checker; empty if it has none."""
    folder = npm_package(HERE, package)
    (program,) = json.loads((folder / "package.json").read_text(encoding="utf-8"))["bin"].values()
    command = [shutil.which("node") or "node", str(folder / program), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=HERE)
    return "" if done.returncode == 0 else (done.stdout + done.stderr)[:8000] or f"{package} has failed"


def test_the_linter_has_no_complaint() -> None:
    """Its command ``check --write`` with the same folders applies its corrections."""
    assert _run("@biomejs/biome", "ci", "--colors=off", "--error-on-warnings", ".", PAGE) == ""


def test_the_types_agree() -> None:
    assert _run("typescript", "--project", HERE) == ""


@pytest.mark.parametrize("file", ["uPlot.esm.js", "uPlot.min.css"])
def test_the_library_is_an_unchanged_copy(file: str) -> None:
    """The README beside it names the version and the hash."""
    copy = (PAGE / "vendor" / file).read_bytes()
    package = npm_package(HERE, "uplot")
    assert copy == (package / "dist" / file).read_bytes()
    readme = (PAGE / "vendor/README.md").read_text(encoding="utf-8")
    version = json.loads((package / "package.json").read_text(encoding="utf-8"))["version"]
    assert f"| `{file}` | npm `uplot` {version}, `dist/{file}` |" in readme
    assert hashlib.sha256(copy).hexdigest() in readme


def test_each_state_in_a_signature_has_a_type() -> None:
    """Without a type, the compiler does not see a wrong key."""
    missing = []
    for path in sorted(PAGE.glob("*.js")):
        lines = path.read_text(encoding="utf-8").split("\n")
        for number, line in enumerate(lines):
            if line.startswith(("export function", "export async function", "function", "async function")):
                comment = "\n".join(lines[max(0, number - 12) : number]).rpartition("/**")[2]
                if "(state" in line and "State} state" not in comment:
                    missing.append(f"{path.name}:{number + 1}: {line}")
    assert missing == []


def test_the_states_of_sessions_have_these_types(tmp_path: Path) -> None:
    """The compiler finds keys that are missing, unknown keys, and values of another type."""
    system = Session([], system=write_pair(tmp_path / "pair"))
    states = {
        "SystemState": [system.state()],
        "State": [*_opened(tmp_path), system.act("open", {"target": "leader"})],
        "StartState": _started(),
    }
    assert [states[name][0]["phase"] for name in states] == ["system", "connect", "choose"]
    assert _compiled(tmp_path, states) == ""
    wrong = states["State"][0]
    wrong["draft"]["can_undo_it"] = wrong["draft"].pop("can_undo")
    assert "'\"can_undo_it\"' does not exist in type 'Draft'" in _compiled(tmp_path, {"State": [wrong]})


def _compiled(folder: Path, states: dict[str, list[dict[str, Any]]]) -> str:
    lines = [f"const of{name}: {name}[] = {json.dumps(found)};\n" for name, found in states.items()]
    (folder / "states.ts").write_text("".join(lines), encoding="utf-8")
    settings = {
        "extends": str(HERE / "tsconfig.json"),
        "compilerOptions": {"strictNullChecks": True},
        "include": [str(PAGE / "types.d.ts"), "states.ts"],
    }
    (folder / "tsconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    return _run("typescript", "--project", folder)


def _started() -> list[dict[str, Any]]:
    """States before a target is chosen: without configurations, which are read in the background, and with them."""
    session = Session([], model=ROOT / "examples/jiwy/model")
    states = [session.state(), session.state()]
    while not states[-1]["configurations"]:
        states[-1] = session.wait(states[-1]["version"], 60)
    return states


def _opened(folder: Path) -> list[dict[str, Any]]:
    """States with an open target: with changes, mistakes, a conflict, hardware, and a build."""
    session = Session([], model=ROOT / "examples/jiwy/model")
    arm = folder / secrets.token_hex(4)  # a folder in which the user has not agreed to build
    body = {"folder": str(arm), "name": "arm", "configuration": "host_jiwy"}
    opened = [session.act("create", body), session.act("disconnect", {"port": "pwm_tilt"})]
    ends = [{"reference": "pwm_pan", "scale": "1/2", "limits": ["-1", "1"]}]
    opened.append(session.act("connect", {"port": "pwm_tilt", "ends": ends}))
    bindings = arm / "arm.bindings.yaml"
    text = bindings.read_text(encoding="utf-8")
    bindings.write_text("inputs: [\n", encoding="utf-8")
    until(lambda: session.wait(session.state()["version"], 1)["draft"]["conflict"] is not None)
    opened.append(session.state())
    bindings.write_text(text, encoding="utf-8")
    opened.append(session.act("reload", {}))
    assert opened[0]["units"] and opened[1]["proposals"] and opened[2]["diagnostics"][0]["notes"]
    assert opened[3]["draft"]["conflict"]

    one_axis = session_of(one_axis_project(folder, "rpi_pico_bare_metal_jiwy"))
    opened += [one_axis.state(), one_axis.act("accept", {})]
    assert opened[-1]["hardware"] and opened[-1]["unused"]

    cmake = arm / "CMakeLists.txt"
    cmake.write_text('message(FATAL_ERROR "No!")\n' + cmake.read_text(encoding="utf-8"), encoding="utf-8")
    opened.append(session.act("generate", {}))
    state = session.act("generate", {"run": opened[-1]["build"]["ask"]["key"]})
    while state["build"]["state"] in ("idle", "running"):
        state = session.wait(state["version"], 60)
    assert state["build"]["messages"]
    return [*opened, state]
