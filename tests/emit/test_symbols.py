# SPDX-License-Identifier: Apache-2.0
"""The C symbols of components differ from all other names in the generated files."""

from __future__ import annotations

import re
import shutil
from collections import Counter
from pathlib import Path

import pytest

from epg.cli.main import main

COMMON = Path(__file__).resolve().parents[1] / "errors" / "common"
FILES = ["--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml", "--output", "out"]
GUARD = "  {}: {{kind: motion_guard, actuator: motor, encoder: encoder, homing: {{travel: 200 deg, time: 10 s}}}}\n"
COMMUNICATION = "communication: {middleware: xrce, console: true}\n"


def generate(folder: Path, target: str, components: list[str], common: Path = COMMON) -> str:
    """The text of ``<target>_app.c``.  The ``components`` are added to those of the robot in ``common``."""
    shutil.copytree(common, folder, dirs_exist_ok=True)
    robot = folder / "robot.tcf"
    text = robot.read_text(encoding="utf-8").replace("rpi_pico_bare_metal", "host")
    text = COMMUNICATION + text + "".join(GUARD.format(component) for component in components)
    robot.write_text(text, encoding="utf-8")
    assert main(["generate", target, *FILES]) == 0
    return (folder / "out" / f"{target}_app.c").read_text(encoding="utf-8")


def defined(code: str) -> list[str]:
    """The names that are defined at file scope."""
    return re.findall(r"^(?:static )?(?:const )?\w[\w ]*?[ *](\w+)(?:\[.*\])?(?: = |;|\()", code, re.M)


def test_no_name_is_defined_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    names = {name for name in defined(generate(tmp_path, "robot", [])) if not name.startswith("robot_")}
    assert {"read_sources", "write_actuators", "monitor_exchange", "model_init"} <= names
    pairs = {(name[: found.start()], name[found.end() :]) for name in names for found in re.finditer("_", name)}
    for target in sorted({target for target, _ in pairs} - {"console"}):  # a header console.h exists already
        components = sorted(component for other, component in pairs if other == target and component != "double")
        shutil.rmtree("out")
        definitions = Counter(defined(generate(tmp_path, target, components)))
        assert definitions.total() > len(names)
        assert set(definitions.values()) == {1}, (target, components, definitions)


def test_functions_for_ports_and_components_have_different_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """``robot_set_go_component()`` sets the port of this name; ``set_go`` is a component."""
    monkeypatch.chdir(tmp_path)
    own = Path(shutil.copytree(COMMON, tmp_path / "own"))
    for file in ("bindings.yaml", "model/model.yaml", "model/controller.h", "model/controller.c"):
        path = own / file
        path.write_text(re.sub(r"\bsetpoint\b", "go_component", path.read_text(encoding="utf-8")), encoding="utf-8")
    code = generate(tmp_path, "robot", ["set_go", "component_set_go"], own)
    header = (tmp_path / "out/robot.h").read_text(encoding="utf-8")
    assert "robot_set_go_component(" in header and "robot_set_go_component" not in defined(code)
    assert set(Counter(defined(code)).values()) == {1}
