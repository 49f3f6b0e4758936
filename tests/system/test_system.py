# SPDX-License-Identifier: Apache-2.0
"""Systems: what their targets become, and what is told about the whole."""

from __future__ import annotations

import json
import os
import shutil
from collections.abc import Mapping
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.outputs import application_outputs
from epg.generator.project import load_application
from epg.generator.resolve.application import ConversionStep
from epg.generator.source import Span
from epg.system.check_system import CheckedSystem, check_system
from epg.system.load_system import load_system
from epg.system.loops import loops_of
from epg.system.ranges import received_range, sent_range
from tests.graph.pictures import Svg

ROOT = Path(__file__).resolve().parents[2]
COMMON = ROOT / "tests/errors/common"

OPEN = """version: 1
model: Controller
inputs: {angle: encoder, go: button}
outputs: {duty: motor, log: unconnected, reset: encoder.reset}
"""
TCF = """version: 1
extends: robot.tcf
components: {target: null, position: null}
"""
SYSTEM = """version: 1
system: chain
targets:
  first: {tcf: robot, model: model, bindings: bindings.yaml}
  next: {tcf: open, model: model, bindings: open.yaml, count: 2, set: {control: {period: 0.5 ms}}}
connections:
  - {from: first/position, to: next_1/setpoint}
  - {from: next_1/log, to: next_2/setpoint, qos: best_effort}
world: {sends: [first/target]}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    shutil.copytree(COMMON, tmp_path, dirs_exist_ok=True)
    (tmp_path / "open.tcf").write_text(TCF)
    (tmp_path / "open.yaml").write_text(OPEN)
    (tmp_path / "chain.system.yaml").write_text(SYSTEM)
    return tmp_path


def checked(folder: Path) -> CheckedSystem:
    diagnostics = Diagnostics()
    system = load_system(folder / "chain.system.yaml", diagnostics)
    assert system is not None, [item.message for item in diagnostics]
    found = check_system(system, (), diagnostics)
    assert found is not None, [item.message for item in diagnostics]
    assert not diagnostics.items
    return found


def texts(system: CheckedSystem, name: str) -> Mapping[str, str]:
    """The generated files of a target."""
    request = system.system.request(system.system.targets[name])
    return application_outputs(system.applications[name], request.roots, PathNames(None))


def topics(system: CheckedSystem, name: str) -> dict[str, str]:
    """The topics of the values of a target, by component, with their quality of service."""
    app = system.applications[name]
    used = (*app.subscriptions, *app.publications)
    return {topic.component.name: f"{topic.name} {topic.qos}" for topic in used if topic.component is not None}


def test_topics_and_namespaces_follow_from_the_sender(folder: Path) -> None:
    system = checked(folder)
    assert [app.namespace for app in system.applications.values()] == ["/chain/first", "/chain/next_1", "/chain/next_2"]
    assert topics(system, "first") == {
        "target": "/chain/first/target reliable",
        "position": "/chain/first/position reliable",
    }
    assert topics(system, "next_1") == {
        "setpoint": "/chain/first/position reliable",
        "log": "/chain/next_1/log best_effort",
    }
    assert topics(system, "next_2") == {"setpoint": "/chain/next_1/log best_effort"}
    assert system.applications["next_2"].period * 2000 == 1


def test_several_targets_receive_a_topic_of_the_world(folder: Path) -> None:
    text = """version: 1
system: chain
targets:
  robot: {tcf: robot, model: model, bindings: bindings.yaml, count: 2}
  other: {tcf: robot, model: model, bindings: bindings.yaml}
world: {sends: [{topic: profile, to: robot/target}, other/target]}
"""
    (folder / "chain.system.yaml").write_text(text)
    system = checked(folder)
    received = {name: topics(system, name)["target"].split()[0] for name in system.applications}
    assert received == {
        "robot_1": "/chain/profile",
        "robot_2": "/chain/profile",
        "other": "/chain/other/target",
    }


def test_the_files_of_a_target_do_not_change_others(folder: Path) -> None:
    before = {name: texts(checked(folder), name) for name in ("first", "next_1", "next_2")}
    robot = folder / "robot.tcf"
    (folder / "changed.tcf").write_text(robot.read_text().replace("frequency: 20 kHz", "frequency: 10 kHz"))
    text = (folder / "chain.system.yaml").read_text()
    (folder / "chain.system.yaml").write_text(text.replace("first: {tcf: robot,", "first: {tcf: changed,"))
    after = {name: texts(checked(folder), name) for name in before}
    assert after["first"] != before["first"]
    assert (after["next_1"], after["next_2"]) == (before["next_1"], before["next_2"])


def test_loops_are_told_with_their_delay(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "chain.system.yaml"
    back = "connections:\n  - {from: next_1/log, to: first/target, qos: best_effort}"
    path.write_text(SYSTEM.replace("world: {sends: [first/target]}", "").replace("connections:", back))
    assert main(["check", str(path)]) == 0
    told = capsys.readouterr().out
    # 33 ms between two messages, then at most a period of the receiver: 0.5 ms and 1 ms
    assert "loop next_1 -> first -> next_1: a value is up to 67.5 ms old" in told
    assert main(["check", "--json", "--hardware", str(path)]) == 0
    data = json.loads(capsys.readouterr().out)
    (system,) = data["systems"]
    assert system["loops"] == [{"targets": ["next_1", "first"], "age": 0.0675}]
    assert [(link["from"], link["to"], link["topic"]) for link in system["connections"]] == [
        ("next_1/log", "first/target", "/chain/next_1/log"),
        ("first/position", "next_1/setpoint", "/chain/first/position"),
        ("next_1/log", "next_2/setpoint", "/chain/next_1/log"),
    ]
    assert set(data["hardware"]) == {"first", "next_1", "next_2"}


@pytest.mark.parametrize(
    ("pairs", "loops"),
    [
        ("ab bc", []),
        ("ab ba", ["ab"]),
        ("ab bc ca ac", ["abc", "ac"]),
        ("ab bc cb", ["bc"]),
        ("ab ba cd dc bc", ["ab", "cd"]),
    ],
)
def test_loops(pairs: str, loops: list[str]) -> None:
    found = ["".join(loop) for loop in loops_of([(pair[0], pair[1]) for pair in pairs.split()])]
    assert sorted(map(sorted, found)) == sorted(map(sorted, loops))


def test_ranges_of_wires() -> None:
    limited = ConversionStep(scale=2, offset=1.0, limits=(-5.0, 7.0))
    assert sent_range((limited, ConversionStep(scale=-10))) == (-70.0, 50.0)
    assert received_range((ConversionStep(scale=-8), limited)) == (-0.375, 0.375)
    assert sent_range(()) == received_range(()) == (float("-inf"), float("inf"))


@pytest.fixture
def example(tmp_path: Path) -> tuple[Path, str]:
    """The system in docs/systems.md, and what the page says that `epg check` prints."""
    page = (ROOT / "docs/systems.md").read_text(encoding="utf-8")
    text = page.partition("<!-- two jiwys -->")[2].partition("<!-- end -->")[0]
    system, told = (block.partition("\n")[2] for block in text.split("```")[1::2])
    for name in ("model", "plant", "jiwy.bindings.yaml", "plant.bindings.yaml"):
        (tmp_path / name).symlink_to(ROOT / "examples/jiwy" / name)
    path = tmp_path / "two_jiwys.system.yaml"
    path.write_text(system)
    return path, told


def test_the_example_in_the_docs(example: tuple[Path, str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(example[0])]) == 0
    assert capsys.readouterr().out == example[1]


def test_the_picture_in_the_docs(example: tuple[Path, str], capsys: pytest.CaptureFixture[str]) -> None:
    """``EPG_UPDATE_GOLDEN=1`` draws it again: review it."""
    assert main(["graph", str(example[0])]) == 0
    text = capsys.readouterr().out
    path = ROOT / "docs/pictures/two-jiwys.svg"
    if os.environ.get("EPG_UPDATE_GOLDEN"):
        path.write_text(text, encoding="utf-8", newline="\n")
    assert path.read_text(encoding="utf-8") == text


def test_pictures_of_systems(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph", str(folder / "chain.system.yaml")]) == 0
    svg = Svg(capsys.readouterr().out)
    assert not svg.overlaps() and not svg.outside()
    heights = {text.text: [other.top for other in svg.texts if other.text == text.text] for text in svg.texts}
    for sender, receiver, title in (
        ("position", 0, "first/position: std_msgs/msg/Float64 to next_1"),
        ("log", 1, "next_1/log: std_msgs/msg/Float64 to next_2"),
    ):
        (line,) = (line for line in svg.lines if line.title == title)
        assert abs(line.points[0][1] - heights[sender][0]) < 10
        assert abs(line.points[-1][1] - heights["setpoint"][receiver]) < 10
    assert [line.title for line in svg.lines if "other programs" in line.title] == ["first/target: from other programs"]


def test_the_plant_of_a_system_in_its_picture(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["graph", str(ROOT / "examples/production_cell/production_cell.system.yaml")]) == 0
    svg = Svg(capsys.readouterr().out)
    assert not svg.overlaps() and not svg.outside()
    wires = [line.title for line in svg.lines if line.title.endswith("moves Production_Cell")]
    assert len(wires) == 6 and wires[0] == "feeder_belt senses and moves Production_Cell"
    assert "6 wires" in svg.words


def test_a_simulated_target_has_the_pwm_steps_of_its_board() -> None:
    """Timers of the boards have other clocks: 125, 150 and 200 MHz."""
    path = ROOT / "examples/production_cell/production_cell.system.yaml"
    system = load_system(path, Diagnostics(), Span(""))
    assert system is not None
    tops = {}
    for name in ("feeder", "robot", "door"):
        request = system.simulated(system.targets[name], f"cell_{name}")
        application = load_application(request, Diagnostics())
        assert application is not None and application.target.platform.name == "simulated"
        (motor,) = (component for component in application.components if component.name == "motor")
        tops[name] = motor.claims["pwm"].settings["top"]
    assert tops == {"feeder": 6249, "robot": 7499, "door": 9999}


def test_agents_of_a_system(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "chain.system.yaml"
    numbers = ["E6614103E72B8C2F", "E6614103E72B8C30", "E6614103E72B8C31"]
    text = SYSTEM.replace("bindings.yaml}", f"bindings.yaml, serial: {numbers[0]}}}")
    path.write_text(text.replace("count: 2,", f"count: 2, serial: [{numbers[1]}, AB],"))
    assert main(["launch", str(path), "--output", str(folder)]) == 1
    assert "'AB' is not the serial number of a board rpi_pico" in capsys.readouterr().err
    assert main(["launch", "--json", str(path), "--board", f"next_2={numbers[2]}", "--output", str(folder)]) == 0
    agents = json.loads(capsys.readouterr().out)["agents"]
    assert [agent["nodes"] for agent in agents] == [
        ["/chain/first/robot"],
        ["/chain/next_1/robot"],
        ["/chain/next_2/robot"],
    ]
    assert [number in agent["device"] for agent, number in zip(agents, numbers)] == [True, True, True]
