# SPDX-License-Identifier: Apache-2.0
"""Runs of a real host executable through scenarios, and the messages if it has an error."""

from __future__ import annotations

import builtins
import csv
import re
import stat
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from epg.cli.report import format_diagnostics
from epg.generator.diagnostics import UserError
from epg.runs import interface as interface_module
from epg.simulate import format_table, simulate

from .motor import compile_motor

REPOSITORY = Path(__file__).resolve().parents[2]
PROFILE = "setpoints: {motor_setpoint: {profile: [{shape: move, start: 0.5 s, duration: 1 s, to: 2 rad}]}}\n"
AXIS = "axes: {motor: {setpoint: motor_setpoint, position: inputs.position, duty: outputs.duty%s}}\n"
REFERENCE = "def reference(axis, time, setpoint):\n    return [0.0 for _ in time]\n"


def scenario(folder: Path, text: str = "", axis: str = "", *, duration: str = "2 s") -> Path:
    path = folder / "scenario.yaml"
    path.write_text(f"version: 1\nduration: {duration}\n{PROFILE}{text}{AXIS % axis}", encoding="utf-8")
    return path


def table(path: Path) -> dict[str, list[str]]:
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


def problems(error: pytest.ExceptionInfo[UserError]) -> list[str]:
    return [f"{item.id}: {item.message}" for item in error.value.diagnostics]


def test_a_run_leaves_its_numbers(motor: Path, tmp_path: Path) -> None:
    said: list[str] = []
    (tmp_path / "ideal.py").write_text(REFERENCE, encoding="utf-8")
    limits = (
        ", homing: {until: 400 ms, duty: 0.01}, windows: [{from: 0.5 s, until: 1.5 s, rms: 0.3 rad, largest: 0.5 rad}]"
    )
    result = simulate(
        motor, scenario(tmp_path, "reference: ideal.py\n", limits), tmp_path / "out", progress=said.append
    )
    assert result.passed
    assert [check.text for check in result.checks] == [
        "motor: RMS error from 0.5 s to 1.5 s",
        "motor: largest error from 0.5 s to 1.5 s",
        "motor: duty while homing",
    ]
    assert result.statistics.cycles == 2000
    assert result.statistics.mode == "simulated"
    assert said[0].startswith("running motor_host: 2 s of simulated time")

    columns = table(tmp_path / "out" / "tracking.csv")
    assert list(columns) == ["time", "motor_setpoint", "motor_reference", "motor_position", "motor_duty"]
    assert len(columns["time"]) == 2000
    assert columns["motor_reference"][399:401] == ["", "0.0"], "no reference before homing has ended"
    errors = [
        float(position) - float(setpoint)
        for time, position, setpoint in zip(columns["time"], columns["motor_position"], columns["motor_setpoint"])
        if 0.5 <= float(time) <= 1.5
    ]
    window = result.windows[0]
    assert window.rms == pytest.approx((sum(error**2 for error in errors) / len(errors)) ** 0.5)
    assert window.largest == max(map(abs, errors))
    positions = [float(p) for t, p in zip(columns["time"], columns["motor_position"]) if 0.5 <= float(t) <= 1.5]
    assert window.deviation == pytest.approx((sum(p * p for p in positions) / len(positions)) ** 0.5)
    assert float(columns["motor_position"][-1]) == pytest.approx(2.0, abs=0.05)
    assert all(file.is_file() for file in result.files)

    text = format_table(result)
    assert "cycles                2000 of 1 ms" in text
    assert f"{window.rms:.4f} rad" in text
    assert "all 3 limits of the scenario hold" in text


def test_an_axis_with_a_long_name_and_without_a_unit(motor: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path)
    path.write_text(path.read_text().replace("{motor: {", "{motor_of_the_turret: {unit: none, "))
    result = simulate(motor, path, tmp_path / "out")
    lines = [line.split() for line in format_table(result).splitlines()]
    assert [word for line in lines for word in line].count("rad") == 0
    assert ["motor_of_the_turret", "0.5", "...", "1.5", "s", f"{result.windows[0].rms:.4f}"] in [x[:6] for x in lines]


def test_two_runs_are_equal(motor: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path)
    for name in ("one", "two"):
        simulate(motor, path, tmp_path / name)
    for file in ("setpoints.csv", "topics.csv", "trace.csv", "tracking.csv"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes(), file


def test_a_limit_that_does_not_hold(motor: Path, tmp_path: Path) -> None:
    limits = ", windows: [{from: 0.5 s, until: 1.5 s, rms: 0.001 rad}]"
    result = simulate(motor, scenario(tmp_path, axis=limits), tmp_path / "out")
    assert not result.passed
    assert "NOT HELD: motor: RMS error from 0.5 s to 1.5 s: " in format_table(result)
    assert "(limit 0.001)" in format_table(result)


def test_events_reach_the_plant(motor: Path, tmp_path: Path) -> None:
    events = """events:
  - {at: 1 s, enable: false}
  - {at: 1.2 s, enable: true}
  - {at: 1.3 s, setpoint: .nan, topic: motor_setpoint}
  - {at: 1.6 s, stall: 2.5 ms}
"""
    result = simulate(motor, scenario(tmp_path, events), tmp_path / "out")
    assert result.statistics.setpoints_dropped == 1
    assert (result.statistics.missed, result.statistics.overruns, result.statistics.cycles) == (1, 2, 1999)
    trace = table(tmp_path / "out" / "trace.csv")
    pwm = dict(zip(trace["time"], map(float, trace["plant.inputs.duty"])))
    assert abs(pwm["0.999"]) > 0.01
    assert pwm["1.1"] == 0.0
    assert abs(pwm["1.25"]) > 0.01
    text = format_table(result)
    assert "1 setpoints dropped" in text
    assert "2 (1 ticks missed)" in text


def test_in_real_time(motor: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path, "events: [{at: 0.2 s, stall: 1 ms}]\n", duration="1.6 s")
    result = simulate(motor, path, tmp_path / "out", realtime=True)
    assert result.statistics.mode == "realtime"
    assert result.statistics.wall_time >= 1.5
    assert [item.id for item in result.diagnostics if item.id != "matplotlib-missing"] == ["no-stall"]
    assert "lateness of cycles" in format_table(result)
    assert result.statistics.scheduler in format_table(result)


def test_a_signal_the_target_does_not_have(motor: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path)
    path.write_text(path.read_text().replace("inputs.position", "inputs.positon"), encoding="utf-8")
    with pytest.raises(UserError) as error:
        simulate(motor, path, tmp_path / "out")
    assert problems(error) == ["unknown-signal: the target has no signal 'inputs.positon'"]
    (item,) = error.value.diagnostics
    assert (item.span.line, item.hint) == (4, "did you mean 'inputs.position'?")


def test_a_topic_the_target_does_not_have(motor: Path, tmp_path: Path) -> None:
    path = scenario(tmp_path)
    path.write_text(path.read_text().replace("motor_setpoint", "motor_stpoint"), encoding="utf-8")
    with pytest.raises(UserError) as error:
        simulate(motor, path, tmp_path / "out")
    text = format_diagnostics(error.value.diagnostics).splitlines()
    message = "error: the target does not subscribe to 'motor_stpoint' [unknown-topic]"
    assert text[0].endswith(f"scenario.yaml:3:13: {message}")
    assert text[-1] == "hint: did you mean 'motor_setpoint'?"


def test_components_the_target_does_not_have(motor: Path, tmp_path: Path) -> None:
    events = """events:
  - {at: 1 s, component: emergency_stpo, level: false}
  - {at: 1.1 s, component: encoder, level: false}
"""
    with pytest.raises(UserError) as error:
        simulate(motor, scenario(tmp_path, events), tmp_path / "out")
    found = error.value.diagnostics
    assert [(item.id, item.span.line, item.span.column, item.message, item.hint) for item in found] == [
        (
            "unknown-component", 5, 26, "the target has no component 'emergency_stpo'",
            "did you mean 'emergency_stop'?",
        ),
        (
            "unknown-component", 6, 28,
            "'encoder' is not a digital input: only the level of a digital input can be forced",
            "its digital inputs: emergency_stop",
        ),
    ]  # fmt: skip


@pytest.fixture(scope="module")
def held_motor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A motor whose plant reports in every cycle that the emergency stop is not pressed, and which starts disabled."""
    output = tmp_path_factory.mktemp("held_motor") / "held_motor"
    return compile_motor(output, "PLANT_HOLDS_INPUT", "ENABLE_AT_START=false")


ENABLE = "events: [{at: 0.1 s, enable: true}, {at: 1 s, component: emergency_stop, level: false}]\n"


def test_a_forced_component_wins_over_the_plant(held_motor: Path, tmp_path: Path) -> None:
    result = simulate(held_motor, scenario(tmp_path, ENABLE + "ends: disabled\n"), tmp_path / "out")
    assert result.passed
    assert (result.statistics.enabled, result.statistics.fault) == (False, "fail-safe")
    enabled = table(tmp_path / "out" / "trace.csv")["enabled"]
    assert (enabled[99], enabled[100], enabled[999], enabled[1000]) == ("0", "1", "1", "0")


@pytest.mark.parametrize(
    ("text", "problem", "hint"),
    [
        ("", "the target was never enabled", "add 'events: [{at: 0 s, enable: true}]' to the scenario"),
        (ENABLE, "the target was disabled at the end (fail-safe: emergency_stop)", "add 'ends: disabled' to it"),
        ("ends: disabled\n", "the target was never enabled", "it starts disabled"),
        (
            "ends: disabled\nevents: [{at: 0 s, enable: true}]\n",
            "the target was enabled at the end, but the scenario has 'ends: disabled'",
            "",
        ),
        (
            "ends: never_enabled\nevents: [{at: 1 s, enable: true}]\n",
            "the target was enabled, but the scenario has 'ends: never_enabled'",
            "",
        ),
        (
            "events: [{at: 0 s, component: emergency_stop, level: false}, {at: 0.1 s, enable: true}]\n",
            "the target was never enabled",
            "a fault keeps it disabled: fail-safe: emergency_stop",
        ),
    ],
)
def test_a_run_that_does_not_end_as_expected(
    held_motor: Path, tmp_path: Path, text: str, problem: str, hint: str
) -> None:
    result = simulate(held_motor, scenario(tmp_path, text), tmp_path / "out")
    assert not result.passed
    assert result.ending.problem == problem
    assert hint in result.ending.hint
    assert f"FAILED: {problem}" in format_table(result)


def test_a_run_that_is_to_stay_disabled(held_motor: Path, tmp_path: Path) -> None:
    assert simulate(held_motor, scenario(tmp_path, "ends: never_enabled\n"), tmp_path / "out").passed


def test_a_plant_that_diverges(tmp_path: Path) -> None:
    program = compile_motor(tmp_path / "motor_host", "PLANT_DIVERGES=1e300")
    with pytest.raises(UserError) as error:
        simulate(program, scenario(tmp_path), tmp_path / "out")
    (item,) = error.value.diagnostics
    assert item.message == (
        "'motor_host' ended with status 1: the plant has diverged: plant.outputs.angle is 1e+300 at 0.143 s"
    )
    assert item.hint.startswith("an output of a plant must be finite")


def test_an_executable_of_an_earlier_version(tmp_path: Path) -> None:
    program = script(tmp_path, "import sys; sys.exit(\"error: unknown option '--interface'\")\n")
    with pytest.raises(UserError) as error:
        simulate(program, scenario(tmp_path), tmp_path / "out")
    assert problems(error) == ["simulation-failed: 'program' does not list its topics and signals"]


def script(folder: Path, text: str) -> Path:
    path = folder / "program"
    path.write_text(f"#!{sys.executable}\n{text}", encoding="utf-8")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


def test_an_executable_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(UserError) as error:
        simulate(tmp_path / "missing", scenario(tmp_path), tmp_path / "out")
    assert problems(error) == ["simulation-failed: cannot run 'missing': No such file or directory"]


def test_an_executable_that_hangs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(interface_module, "patience", lambda duration: 0.5)
    with pytest.raises(UserError) as error:
        # a controller that is too slow
        simulate(script(tmp_path, "import time; time.sleep(60)\n"), scenario(tmp_path), tmp_path / "out")
    assert problems(error) == ["simulation-failed: 'program' did not end"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "def reference(axis, time, setpoint): return setpoint[1:]\n",
            "reference() must return 2000 finite values for axis 'motor'",
        ),
        (
            "def reference(axis, time, setpoint): return [float('nan')] * len(time)\n",
            "reference() must return 2000 finite values",
        ),
        (
            "def reference(axis, time, setpoint): return 1 / 0\n",
            "reference() failed for axis 'motor': ZeroDivisionError",
        ),
        ("def refrence(): pass\n", "cannot load the reference: AttributeError"),
        ("this is no Python\n", "cannot load the reference: SyntaxError"),
    ],
)
def test_a_wrong_reference(motor: Path, tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "ideal.py").write_text(text, encoding="utf-8")
    with pytest.raises(UserError) as error:
        simulate(motor, scenario(tmp_path, "reference: ideal.py\n"), tmp_path / "out")
    assert problems(error)[0].startswith(f"wrong-reference: {message}")


def test_without_matplotlib(motor: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    original = builtins.__import__

    def without(name: str, *arguments: Any, **keywords: Any) -> Any:
        if name.split(".")[0] == "matplotlib":
            raise ImportError("No module named 'matplotlib'")
        return original(name, *arguments, **keywords)

    monkeypatch.setattr(builtins, "__import__", without)
    result = simulate(motor, scenario(tmp_path), tmp_path / "out")
    (warning,) = result.diagnostics
    assert (warning.id, warning.severity) == ("matplotlib-missing", "warning")
    assert "pip install matplotlib" in warning.hint
    assert not (tmp_path / "out" / "tracking.png").exists()
    assert result.passed


def test_the_plot_is_drawn(motor: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    result = simulate(motor, scenario(tmp_path, axis=", homing: {until: 0.4 s}"), tmp_path / "out")
    plot = tmp_path / "out" / "tracking.png"
    assert plot in result.files
    assert plot.read_bytes().startswith(b"\x89PNG")
    assert plot.stat().st_size > 20_000


def test_the_plot_shows_the_state_of_the_target(motor: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure

    texts: list[str] = []

    def keep(figure: Figure, *_: object, **__: object) -> None:
        for panel in figure.axes:
            texts.extend([panel.get_ylabel(), panel.get_title(loc="left"), *(text.get_text() for text in panel.texts)])
            texts.extend(text.get_text() for text in (panel.get_legend().get_texts() if panel.get_legend() else ()))

    monkeypatch.setattr(Figure, "savefig", keep)
    window = ", windows: [{from: 0.2 s, until: 0.8 s, rms: 1e-9 rad, largest: 10 rad}]"
    simulate(motor, scenario(tmp_path, "events: [{at: 0.9 s, enable: false}]\n", axis=window), tmp_path / "out")
    for expected in (
        "disabled",
        "error: setpoint - position",
        "duty (1)",
        "limit of the RMS",
        "limit of the largest error",
    ):
        assert expected in texts, texts
    assert any(text.startswith("not held: RMS") for text in texts)


def test_the_names_of_faults_are_those_of_the_runtime() -> None:
    from epg.simulate.marks import FAULTS

    header = (REPOSITORY / "targets/runtime/include/epg/fault.h").read_text(encoding="utf-8")
    names = (REPOSITORY / "targets/runtime/src/communication/fault.c").read_text(encoding="utf-8")
    known, number = {}, -1
    for name, given in re.findall(r"^    EPG_FAULT_(\w+)(?: = (\w+))?,", header, re.MULTILINE):
        number = int(given, 0) if given else number + 1
        found = re.search(rf'EPG_FAULT_{name}\] = "(.*?)"', names)
        assert found, name
        known[number] = found[1]
    for kind in sorted((REPOSITORY / "targets/components").glob("*/component.yaml")):
        faults = yaml.safe_load(kind.read_text(encoding="utf-8")).get("faults", {})
        known |= {fault["number"]: name for name, fault in faults.items() if "number" in fault}
    assert dict(sorted(known.items())) == {0: "none", **FAULTS}
