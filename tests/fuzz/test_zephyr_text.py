# SPDX-License-Identifier: Apache-2.0
"""A user's text for Zephyr: it has no effect in the devicetree overlay, in Kconfig, or in CMake's part.

Each text is either refused with a position, or the three files are those of a project without it, except for the names
that the text gives.  (``tests/zephyr/generate`` tests that dtc reads the overlay as intended.)
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from tests.fuzz.compiler import ROOT
from tests.fuzz.long_run import examples
from tests.fuzz.project import Outcome, Project, project_files
from tests.fuzz.test_user_text import in_yaml, replaced

FEW = ["*/ / { evil = <1>; }; /*", '"; evil = "1', "x\nconfig EVIL\n\tdefault y"]
MORE = [
    '*/ #include "/etc/passwd" /*',
    "x>; evil = <1",
    "}; / { evil",
    "x\n#include <evil>",
    "x\nsource /etc/passwd",
    "# evil",
    "$(shell,touch evil)",
    "$(HOME)",
    "\\",
    "x\\",
    "&evil",
    "/delete-node/ &gpio0;",
    '/incbin/("/etc/passwd")',
    "${CMAKE_SOURCE_DIR}",
    "evil;y",
    "@evil@",
    "é",
    "%s",
]  # fmt: skip
HOSTILE = [*FEW, *(MORE if examples(1) > 1 else [])]  # each takes half a second at each place
OUTPUTS = ("robot.overlay", "robot.Kconfig", "robot_zephyr.cmake")
ARGUMENTS = ("--tcf", "robot.tcf", "--model", "model", "--bindings", "robot.bindings.yaml")
TCF = """version: 1
extends: rpi_pico_zephyr_jiwy.tcf
node: robot
namespace: /lab
components:
  pan_publisher: {topic: pan}
"""


@cache
def files() -> dict[str, bytes]:
    """JIWY on a Pico with Zephyr, with the user's own board and chip."""
    found = project_files(ROOT / "examples/jiwy/model", "model")
    found |= {"robot.tcf": TCF.encode()}
    found["robot.bindings.yaml"] = (ROOT / "examples/jiwy/jiwy.bindings.yaml").read_bytes()
    found |= project_files(ROOT / "targets/boards/rpi_pico", "targets/boards/rpi_pico")
    return found


def generated(folder: Path, changed: dict[str, bytes], *arguments: str) -> Outcome:
    return Project(folder, changed, (*ARGUMENTS, *arguments)).generate(targets="targets")


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    outcome = generated(tmp_path_factory.mktemp("usual") / "p", files())
    assert outcome.good, outcome.messages
    assert set(OUTPUTS) <= set(outcome.files)
    return {name: outcome.files[name] for name in OUTPUTS}


def check(outcome: Outcome, usual: dict[str, str]) -> None:
    if outcome.good:
        assert {name: outcome.files[name] for name in OUTPUTS} == usual
    else:
        assert outcome.errors and "a bug in EPG" not in outcome.messages


@pytest.mark.parametrize("text", HOSTILE, ids=repr)
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("node: robot", "node: {}"),
        ("namespace: /lab", "namespace: {}"),
        ("{topic: pan}", "{{topic: {}}}"),
        ("  pan_publisher:", "  {}: {{kind: digital_output, pin: 2}}\n  pan_publisher:"),
        ("node: robot", "node: robot\nconsole: {}"),
        ("node: robot", "node: robot\ntarget: {}"),
        ("node: robot", "node: robot\ncommunication: {{transport: {}}}"),
        ("node: robot", "node: robot\ncommunication: {{middleware: {}}}"),
    ],
    ids=["node", "namespace", "topic", "component", "console", "target", "transport", "middleware"],
)
def test_texts_of_a_tcf(old: str, new: str, text: str, usual: dict[str, str], tmp_path: Path) -> None:
    outcome = generated(tmp_path / "p", replaced(files(), "robot.tcf", old, new.format(in_yaml(text))))
    check(outcome, usual)
    assert not outcome.good, "all of these are names"


@pytest.mark.parametrize("text", HOSTILE, ids=repr)
@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("summary: Raspberry Pi Pico", "summary: {}"),
        ("zephyr: rpi_pico}", "zephyr: {}}}"),
        ("{title: the LED on the board,", "{{title: {},"),
        ("console: uart0", "console: {}"),
        ("    uart0: [0, 1]", "    {}: [0, 1]"),
        ("    i2c0: [4, 5]", "    {}: [10, 11]"),
        ("names: {LED: 25}", "names: {{{}: 25}}"),
        ("prefixes: [GP, GPIO]", "prefixes: [GP, {}]"),
        ("23: it selects the power-save mode of the board's regulator", "23: {}"),
    ],
    ids=["summary", "sdk", "title", "console", "node", "used-node", "name", "prefix", "reserved"],
)
def test_texts_of_a_board(old: str, new: str, text: str, usual: dict[str, str], tmp_path: Path) -> None:
    board = "targets/boards/rpi_pico/board.yaml"
    outcome = generated(tmp_path / "p", replaced(files(), board, old, new.format(in_yaml(text))))
    if outcome.good and "zephyr: {" in new:  # the quoted name of the board, which CMake compares with BOARD
        assert all(outcome.files[name] == usual[name] for name in ("robot.overlay", "robot.Kconfig"))
        return
    check(outcome, usual)


@pytest.mark.parametrize("text", HOSTILE, ids=repr)
def test_texts_of_a_model(text: str, usual: dict[str, str], tmp_path: Path) -> None:
    """20-sim's description of a port is only in comments of C."""
    changed = files()
    source = changed["model/xxsubmod.c"].decode()
    assert "/* setpoint_pan" in source
    shown = text.replace("*/", "").replace("\n", " ")
    changed = changed | {"model/xxsubmod.c": source.replace("/* setpoint_pan", f"/* setpoint_pan {{{shown}}}").encode()}
    check(generated(tmp_path / "p", changed), usual)
