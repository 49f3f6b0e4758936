# SPDX-License-Identifier: Apache-2.0
"""``epg describe``: layouts that PlotJuggler and Foxglove read, with the names that they give to values."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import pytest

from epg.cli.main import main
from epg.generator.messages.library import Library, known_message

from .description import topic, write_description

ROOT = Path(__file__).resolve().parents[2]

JOINTS = topic(
    "joint_states",
    "sensor_msgs/msg/JointState",
    component="joints",
    values=["joint_states/pan.position", "joint_states/tilt.position", "joint_states/tilt.velocity"],
    elements=[f"{joint}.{part}" for joint in ("pan", "tilt") for part in ("position", "velocity", "effort")],
)
COMMANDS = topic(
    "commands",
    "std_msgs/msg/Float64MultiArray",
    component="commands",
    values=["commands/pan", "commands/tilt"],
    elements=["spare", "pan", "tilt"],
)
VELOCITY = topic(
    "velocity",
    "geometry_msgs/msg/TwistStamped",
    component="velocity",
    values=["velocity/linear_x", "velocity/angular_z"],
    elements=["linear_x", "angular_z"],
)


def wire(component: str, component_port: str, port: str, unit: str) -> dict[str, str]:
    return {
        "component": component,
        "component_port": component_port,
        "port": port,
        "unit": unit,
        "component_unit": unit,
    }


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    file = write_description(
        tmp_path / "arm.json", namespace="/cell", subscriptions=[COMMANDS], publications=[JOINTS, VELOCITY]
    )
    data = json.loads(file.read_text(encoding="utf-8"))
    data["inputs"] = [wire("commands", f"{axis}", f"setpoint_{axis}", "rad") for axis in ("pan", "tilt")]
    data["outputs"] = [
        wire("joints", "pan.position", "pan", "rad"),
        wire("joints", "tilt.position", "tilt", "rad"),
        wire("joints", "tilt.velocity", "tilt_rate", "rad/s"),
        wire("velocity", "linear_x", "v", "m/s"),
        wire("velocity", "angular_z", "w", "rad/s"),
    ]
    file.write_text(json.dumps(data), encoding="utf-8")
    return file


def areas(element: Element) -> Iterator[Element]:
    """The plots below a splitter, read as PlotDocker::restoreSplitter() reads them."""
    assert element.tag == "DockSplitter" and element.attrib["orientation"] in ("|", "-")
    sizes = [float(size) for size in element.attrib["sizes"].split(";")]
    assert int(element.attrib["count"]) == len(element) == len(sizes) and abs(sum(sizes) - 1) < 1e-3
    for child in element:
        if child.tag == "DockSplitter":
            yield from areas(child)
        else:
            assert child.tag == "DockArea"
            yield child


def plotjuggler(path: Path) -> tuple[dict[str, list[str]], dict[str, tuple[str, str, str]]]:
    """The curves of each plot by its title, and the computed curves: function, linked source, other source."""
    root = ElementTree.parse(path).getroot()
    (tabs,) = root.iter("tabbed_widget")
    assert (root.tag, tabs.attrib["name"], tabs.attrib["parent"]) == ("root", "Main Window", "main_window")
    found = {}
    for container in tabs.iter("Container"):
        (splitter,) = container
        for area in areas(splitter):
            plot = area.find("plot")
            assert plot is not None and plot.attrib["mode"] == "TimeSeries"
            found[area.attrib["name"]] = [curve.attrib["name"] for curve in plot.iter("curve")]
            assert all(re.fullmatch("#[0-9a-f]{6}", curve.attrib["color"]) for curve in plot.iter("curve"))
    computed = {
        snippet.attrib["name"]: tuple(
            (snippet.findtext(place) or "").strip() for place in ("function", "linked_source", "additional_sources/v1")
        )
        for snippet in root.iter("snippet")
    }
    return found, computed


def leaves(library: Library, message: str, separator: str) -> Iterator[str]:
    """The paths to all numbers of a message, as regular expressions, by its definition."""
    for field in library[message].fields:
        index = "" if field.type.form == "one" else r"\[\d+\]"
        if field.type.is_message:
            for rest in leaves(library, field.type.base, separator):
                yield f"{field.name}{index}{separator}{rest}"
        else:
            yield field.name + index


def is_value(name: str, topics: dict[str, str], separator: str) -> bool:
    """True if ``name`` is a number of a topic, by the definition of its message."""
    return any(
        re.fullmatch(re.escape(topic) + re.escape(separator) + leaf, name)
        for topic, type in topics.items()
        for leaf in leaves(known_message(type), type, re.escape(separator))
    )


TOPICS = {
    "/cell/commands": "std_msgs/msg/Float64MultiArray",
    "/cell/joint_states": "sensor_msgs/msg/JointState",
    "/cell/velocity": "geometry_msgs/msg/TwistStamped",
}


def test_plotjuggler_finds_every_curve(robot: Path) -> None:
    assert main(["describe", str(robot), "--plotjuggler", "--output", str(robot.parent)]) == 0
    plots, computed = plotjuggler(robot.parent / "arm.plotjuggler.xml")
    assert plots == {
        "pan [rad]": ["/cell/commands/data[1]", "/cell/joint_states/pan/position", "error/joint_states/pan.position"],
        "tilt [rad]": [
            "/cell/commands/data[2]",
            "/cell/joint_states/tilt/position",
            "error/joint_states/tilt.position",
        ],
        "velocity [rad/s]": [
            "/cell/joint_states/tilt/velocity",
            "/cell/velocity/twist/angular/z",
        ],
        "velocity/linear_x [m/s]": ["/cell/velocity/twist/linear/x"],
    }
    for curves in plots.values():
        for curve in curves:
            # ParserROS::parseJointStateMsg() names joints; all other names follow the definition of the message.
            joint = re.fullmatch(r"/cell/joint_states/(pan|tilt)/(position|velocity|effort)", curve)
            assert joint or curve in computed or is_value(curve, TOPICS, "/"), curve
    assert computed["error/joint_states/pan.position"] == (
        "return v1 - value",
        "/cell/joint_states/pan/position",
        "/cell/commands/data[1]",
    )


def places(node: Any) -> Iterator[str]:
    """The panels of a mosaic, read as react-mosaic reads them."""
    if isinstance(node, str):
        yield node
        return
    assert set(node) == {"direction", "first", "second", "splitPercentage"}
    assert node["direction"] in ("row", "column") and 0 < node["splitPercentage"] < 100
    yield from places(node["first"])
    yield from places(node["second"])


def test_foxglove_finds_every_value(robot: Path) -> None:
    """The keys are those of LayoutData and PlotConfig in the sources of Lichtblick."""
    assert main(["describe", str(robot), "--foxglove", "--output", str(robot.parent)]) == 0
    layout = json.loads((robot.parent / "arm.foxglove.json").read_text(encoding="utf-8"))
    assert set(layout) == {"configById", "globalVariables", "userNodes", "playbackConfig", "layout"}
    assert list(places(layout["layout"])) == list(layout["configById"])
    values = {}
    for id, panel in layout["configById"].items():
        assert id.startswith("Plot!") and panel["xAxisVal"] == "timestamp"
        assert {"showLegend", "legendDisplay", "showPlotValuesInLegend", "showXAxisLabels"} < set(panel)
        assert {"showYAxisLabels", "isSynced", "sidebarDimension", "paths"} < set(panel)
        assert all(set(path) == {"value", "label", "enabled", "timestampMethod"} for path in panel["paths"])
        values[panel["foxglovePanelTitle"]] = [path["value"] for path in panel["paths"]]
        assert all(is_value(path["value"], TOPICS, ".") for path in panel["paths"])
    assert values["tilt [rad]"] == ["/cell/commands.data[2]", "/cell/joint_states.position[1]"]
    methods = [{p["timestampMethod"] for p in panel["paths"]} for panel in layout["configById"].values()]
    assert methods == [{"receiveTime"}, {"receiveTime"}, {"headerStamp"}, {"headerStamp"}]


@pytest.mark.parametrize("robot", ["jiwy", "relbot"])
def test_each_axis_of_the_examples_has_its_plot(robot: str, tmp_path: Path) -> None:
    example = ROOT / "examples" / robot
    command = [sys.executable, str(ROOT / "epg"), "generate", robot, "--tcf", f"host_{robot}.tcf"]
    command += ["--model", str(example / "model"), "--bindings", str(example / f"{robot}.bindings.yaml")]
    subprocess.run([*command, "--output", str(tmp_path)], check=True, capture_output=True)
    describe = ["describe", str(tmp_path / f"{robot}.json"), "--board", "host", "--plotjuggler", "--foxglove"]
    assert main([*describe, "--output", str(tmp_path)]) == 0
    plots, computed = plotjuggler(tmp_path / f"{robot}.plotjuggler.xml")
    axes = {"jiwy": ("pan", "tilt"), "relbot": ("left", "right")}[robot]
    assert [title.partition(" [")[0] for title in plots] == list(axes)
    assert all(len(curves) == 3 and curves[2] in computed for curves in plots.values())
    first = (tmp_path / f"{robot}.plotjuggler.xml").read_bytes(), (tmp_path / f"{robot}.foxglove.json").read_bytes()
    assert main([*describe, "--output", str(tmp_path)]) == 0, "the same again changes nothing"
    assert first == (
        (tmp_path / f"{robot}.plotjuggler.xml").read_bytes(),
        (tmp_path / f"{robot}.foxglove.json").read_bytes(),
    )


def test_what_is_missing_is_told(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["describe", str(robot)]) == 2
    assert "add --plotjuggler, --foxglove or --ros2-control" in capsys.readouterr().err
    (robot.parent / "arm.plotjuggler.xml").write_text("mine", encoding="utf-8")
    assert main(["describe", str(robot), "--plotjuggler", "--output", str(robot.parent)]) == 1
    assert "this file exists" in capsys.readouterr().err


EVERYTHING = ["--plotjuggler", "--foxglove", "--ros2-control", "--force", "--board", "host"]
OTHERS = (None, True, -1, 1e300, 7, "", "a/b c", [], [[1]], {}, {"a": None})
"""A value of a description is replaced by each of these."""


def nodes(value: Any, path: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """The paths to all values of a document, the outermost first; lists of many similar values by their first two."""
    yield path
    children = value.items() if isinstance(value, dict) else enumerate(value[:2]) if isinstance(value, list) else ()
    for key, child in children:
        yield from nodes(child, (*path, key))


def damaged(data: Any, path: tuple[str | int, ...], value: object) -> Any:
    """A copy of ``data`` in which ``value`` is at ``path``."""
    if not path:
        return value
    copy = dict(data) if isinstance(data, dict) else list(data)
    copy[path[0]] = damaged(data[path[0]], path[1:], value)
    return copy


@pytest.fixture(params=["robot", "generated"])
def description(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    if request.param == "generated":
        file = tmp_path / "jiwy.json"
        command = ["generate", "jiwy", "--tcf", "rpi_pico_bare_metal_jiwy.tcf", "--output", str(tmp_path)]
        command += ["--model", str(ROOT / "examples/jiwy/model")]
        assert main([*command, "--bindings", str(ROOT / "examples/jiwy/jiwy.bindings.yaml")]) == 0
        return file
    file = request.getfixturevalue("robot")
    data = json.loads(file.read_text(encoding="utf-8"))
    data["control"] = {"enable_at_start": False}
    data["communication"] |= {
        "domain": 3,
        "usb": {"manufacturer": "A", "vendor_id": 4, "serial": "B", "serial_digits": 8},
    }
    data["subscriptions"][0] |= {"timeout": 0.5, "on_timeout": "disable"}
    data["publications"].append(topic("state", "arm/msg/State", values=["state/a.0"], elements=["a.0"]))
    data["messages"] = {"arm/msg/State": "std_msgs/Header header\nfloat64[2] a\n"}
    file.write_text(json.dumps(data, indent=1), encoding="utf-8")
    return file


def test_a_damaged_description_is_never_a_bug(description: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file is cut at every 50th byte, and each of its values is replaced by values of other types."""
    text = description.read_bytes()
    data = json.loads(text)
    files = [text[:end] for end in range(0, len(text), 50)]
    files += [json.dumps(damaged(data, path, value)).encode() for path in nodes(data) for value in OTHERS]
    capsys.readouterr()
    refused = 0
    for content in files:
        description.write_bytes(content)
        status = main(["describe", str(description), *EVERYTHING, "--output", str(description.parent / "out")])
        said = capsys.readouterr().err
        assert status in (0, 1), f"{said}\n{content.decode(errors='replace')}"
        assert status == 0 or str(description) in said
        refused += "[description-damaged]" in said
    assert refused > len(files) / 4


def test_a_damaged_description_is_named_with_the_command_that_writes_it(
    robot: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    build = robot.parent / "my build"
    file = build / "epg/arm/arm.json"
    file.parent.mkdir(parents=True)
    (build / "CMakeCache.txt").touch()
    data = json.loads(robot.read_text(encoding="utf-8"))
    data["communication"]["period"] = "33 ms"
    file.write_text(json.dumps(data), encoding="utf-8")
    for place in (file, build):
        assert main(["describe", str(place), "--plotjuggler"]) == 1
        said = capsys.readouterr().err
        assert f"{file}: error: " in said and "'communication.period' is not a possible number" in said
        assert f"hint: run \"cmake '{build}'\": CMake then writes this file again" in said
