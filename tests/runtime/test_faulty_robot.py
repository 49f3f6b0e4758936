# SPDX-License-Identifier: Apache-2.0
"""A real executable with its simulated robot: the effect of broken and swapped wires, and the times of probes."""

from __future__ import annotations

import csv
import json
import math
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from .program import ROOT

SOURCE = Path(__file__).resolve().parent / "faulty_robot"
JIWY = ROOT / "examples" / "jiwy"
THERMAL_SWITCH = {
    "component.yaml": """\
api: 1
kind: thermal_switch
summary: a switch that closes when something is too hot
pins: [contact]
parameters: {pull: {type: string, default: up, description: resistor of the pin}}
claims: {level: {class: digital_input, output: false, signals: {value: contact}, attributes: {pull: pull}}}
faults: {too hot: {description: the contact is closed, remedy: let it cool down}}
""",
    "code.c.j2": """\
{% macro start(c) %}
    epg_port_input_start({{ c.claims['level'].pins['value'] }}, EPG_PULL_UP);
{% endmacro %}
{% macro check(c) %}
epg_port_input_read({{ c.claims['level'].pins['value'] }}) ? EPG_FAULT_NONE : {{ c.faults['too hot'] }}
{%- endmacro %}
""",
}
"""A kind that a user adds.  EPG names it nowhere."""
TOO_HOT = 37096
"""The number of its fault.  A trace that was recorded once must stay readable, so it never changes."""
STALL_S = 0.5
RUNAWAY_RAD = math.radians(20)


@dataclass(frozen=True)
class Run:
    """A run of the robot: one entry per control cycle of 1 ms."""

    trace: dict[str, list[float]]
    statistics: dict[str, Any]
    summary: str

    def first(self, column: str, value: float) -> float | None:
        """The first time at which a column has a value."""
        return next((time for time, found in zip(self.trace["time"], self.trace[column]) if found == value), None)

    def at(self, time: float, column: str) -> float:
        return self.trace[column][round(time * 1000)]


@pytest.fixture(scope="session")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("faulty_robot")
    environment = {k: v for k, v in os.environ.items() if k not in ("EPG_DIR", "EPG_PATH")}
    environment["EPG_TARGETS_PATH"] = str(folder / "targets")
    kind = folder / "targets/components/thermal_switch"
    kind.mkdir(parents=True)
    for name, text in THERMAL_SWITCH.items():
        (kind / name).write_text(text)
    options = [f"-DJIWY={JIWY}", f"-DEPG_DIR={ROOT / 'cmake'}", f"-DPython3_EXECUTABLE={sys.executable}"]
    options += [f"-DEPG_RUNTIME={ROOT / 'targets/runtime/include'}", "-DCMAKE_BUILD_TYPE=Release"]
    for command in (["cmake", "-S", SOURCE, "-B", folder, "-G", "Ninja", *options], ["cmake", "--build", folder]):
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder


def run(robot: Path, folder: Path, wiring: str, *events: str, seconds: float = 16) -> Run:
    """Homing, then a move of pan by 2 rad in 3 s from 9 s on, with these faults."""
    moves = [f"{9 + 0.033 * k:.3f},pan_subscriber,{min(2.0, 0.022 * k):.3f}" for k in range(200)]
    lines = sorted([*moves, *events], key=lambda line: float(line.partition(",")[0]))
    (folder / "in.csv").write_text("time,topic,value\n" + "\n".join(lines) + "\n")
    files = ["--setpoints", "in.csv", "--trace", "out.csv", "--statistics", "out.json"]
    command = [robot / "jiwy_host", "--duration", str(seconds), *files]
    environment = os.environ | {"WIRING": wiring}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=True)
    with (folder / "out.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    trace = {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}
    return Run(trace, json.loads((folder / "out.json").read_text()), done.stdout)


def check_fault(found: Run, fault: str, component: str, at: float) -> None:
    """Disabled by this fault at this time, with its component, latched; no voltage at the motors from that cycle on."""
    assert (found.statistics["fault"], found.statistics["fault_component"]) == (fault, component)
    assert f"{fault} ({component})" in found.summary
    assert found.statistics["faults"] == 1
    assert found.first("enabled", 0.0) == at
    after = [k for k, time in enumerate(found.trace["time"]) if time >= at]
    for axis in ("pan", "tilt"):
        assert {found.trace[f"plant.inputs.duty_{axis}"][k] for k in after} == {0.0}
        angles = [found.trace[f"plant.outputs.angle_{axis}"][k] for k in after]
        assert abs(angles[-1] - angles[-500]) < 1e-6, "it has come to rest"
    assert set(found.trace["enabled"][after[0] :]) == {0.0}


def driven_from(found: Run, duty: float, since: float) -> float:
    """The time at which the magnitude of the pan motor's duty first reached ``duty``."""
    return next(
        time
        for time, applied in zip(found.trace["time"], found.trace["plant.inputs.duty_pan"])
        if time >= since and abs(applied) >= duty
    )


def test_right_wires_are_no_fault(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "right@0")
    assert found.statistics["fault"] == "none"
    assert found.statistics["fault_component"] == ""
    assert found.at(15.9, "plant.outputs.angle_pan") == pytest.approx(2.0, abs=0.02)


def test_encoder_that_dies_while_the_axis_moves(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "encoder-dead@10")
    at = found.first("enabled", 0.0)
    assert at is not None
    check_fault(found, "stall", "guard_pan", at)
    begun = driven_from(found, 0.3, 10.0)  # first only briefly, with each new setpoint; steadily a little later
    assert STALL_S - 0.002 <= at - begun < STALL_S + 0.15
    duties = found.trace["plant.inputs.duty_pan"][round(begun * 1000) : round(at * 1000)]
    assert 0 <= sum(duty >= 0.3 for duty in duties) - STALL_S * 1000 < 60
    assert max(map(abs, found.trace["plant.inputs.duty_pan"])) > 0.8, "nothing else would have stopped it"


def test_encoder_whose_wires_are_swapped(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "encoder-swapped@10")
    at = found.first("enabled", 0.0)
    assert at is not None
    check_fault(found, "runaway", "guard_pan", at)
    assert 10.0 < at < 10.5
    moved = found.at(at, "plant.outputs.angle_pan") - found.at(10.0, "plant.outputs.angle_pan")
    assert RUNAWAY_RAD <= moved < 2 * RUNAWAY_RAD + 0.1


def test_motor_whose_wires_are_swapped(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "motor-swapped@10")
    at = found.first("enabled", 0.0)
    assert at is not None
    check_fault(found, "runaway", "guard_pan", at)
    moved = found.at(10.0, "plant.outputs.angle_pan") - found.at(at, "plant.outputs.angle_pan")
    assert RUNAWAY_RAD * 0.9 <= moved < 2 * RUNAWAY_RAD + 0.1


def test_motor_that_is_unplugged(robot: Path, tmp_path: Path) -> None:
    """The fault depends on the applied duty, not on the motor's reaction to it."""
    found = run(robot, tmp_path, "motor-unplugged@10")
    assert (found.statistics["fault"], found.statistics["fault_component"]) == ("stall", "guard_pan")


def test_setpoint_beyond_the_end_stop(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "right@0", "15.7,pan_subscriber,4.5", seconds=20)
    at = found.first("enabled", 0.0)
    assert at is not None
    check_fault(found, "stall", "guard_pan", at)
    assert 16.2 < at < 17.0
    assert found.at(at, "plant.outputs.angle_pan") == pytest.approx(math.pi, abs=0.05)


def test_homing_that_goes_farther_than_the_axis_can(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "encoder-counts-thrice@0", seconds=6)
    at = found.first("enabled", 0.0)
    assert at is not None
    check_fault(found, "homing travel", "guard_pan", at)
    travelled = 1.2 - found.at(at, "plant.outputs.angle_pan")
    assert travelled == pytest.approx(math.radians(200) / 3, abs=0.01)


def test_homing_that_does_not_end(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "motor-unplugged@0", seconds=6)
    at = found.first("enabled", 0.0)
    assert at is not None
    check_fault(found, "homing time", "guard_pan", at)
    assert at == pytest.approx(4.0, abs=0.05)


def test_decoder_that_stops(robot: Path, tmp_path: Path) -> None:
    """Safe in the same cycle; enabling has no effect during the fault, and starts homing after it."""
    found = run(robot, tmp_path, "decoder-halted@10", "11,$enable,1", "13,$enable,1", seconds=20)
    enabled = found.trace["enabled"]
    assert enabled[9_999] == 1.0
    assert set(enabled[10_000:13_000]) == {0.0}
    assert {found.at(k / 1000, "plant.inputs.duty_pan") for k in range(10_000, 13_000)} == {0.0}
    assert set(enabled[13_000:]) == {1.0}
    assert found.statistics["faults"] == 2
    assert found.statistics["fault"] == "none"
    assert min(found.trace["plant.outputs.angle_pan"][13_000:]) == pytest.approx(0.0, abs=0.01)
    short = run(robot, tmp_path, "decoder-halted@10", seconds=11)
    check_fault(short, "sensor", "encoder_pan", 10.0)


def test_fault_of_a_kind_of_the_user(robot: Path, tmp_path: Path) -> None:
    found = run(robot, tmp_path, "right@0", "10,$component:supply,0", seconds=11)
    check_fault(found, "too hot", "supply", 10.0)
    assert {found.at(k / 1000, "fault") for k in range(10_000, 11_000)} == {TOO_HOT}


def test_axis_that_is_turned_by_hand_while_disabled(robot: Path, tmp_path: Path) -> None:
    """Teleoperation: the leading robot is disabled, and its model reads a motion that looks like several faults."""
    found = run(robot, tmp_path, "encoder-turned-by-hand@9.5", "9.4,$enable,0")
    assert found.statistics["fault"] == "none"
    assert found.statistics["faults"] == 0
    assert set(found.trace["enabled"][9_400:]) == {0.0}
    positions = found.trace["inputs.position_pan"][9_500:]
    assert max(positions) - min(positions) > 5.0
    assert max(map(abs, found.trace["outputs.pwm_pan"][9_500:])) > 0.9, "the model would have driven"


def signals(robot: Path, folder: Path, seconds: float, *events: str) -> list[tuple[int, str, int]]:
    """Every access of the program to its hardware: time in ns, signal and value; probes by their names."""
    # The host numbers pins in the order of the .tcf: four of the encoders, six of the bridges.
    names = {10 + number: name for number, name in enumerate(PROBES)}
    (folder / "in.csv").write_text("time,topic,value\n" + "".join(f"{event}\n" for event in events))
    command = [
        robot / "jiwy_host",
        "--quiet",
        "--duration",
        str(seconds),
        "--setpoints",
        "in.csv",
        "--topics",
        "topics.csv",
    ]
    subprocess.run(command, cwd=folder, env=os.environ | {"SIGNALS": "signals"}, check=True)
    result = []
    for line in (folder / "signals").read_text().splitlines():
        time, what, value = line.split()
        pin = int(what[3:]) if what.startswith("pin") else -1
        result.append((int(time), names.get(pin, what), int(value)))
    return result


PROBES = ["cycle", "inputs", "model", "outputs", "setpoint", "position"]


def test_probes_stand_between_what_they_separate(robot: Path, tmp_path: Path) -> None:
    found = signals(robot, tmp_path, 0.1)
    cycles: dict[int, list[str]] = {}
    for time, what, _ in found:
        cycles.setdefault(time // 1_000_000, []).append(what)
    for number in range(2, 99):
        order = [what for what in cycles[number] if not what.startswith("pin") and what != "position"]
        assert order[:4] == ["cycle", "encoder0", "encoder1", "inputs"], number
        assert order[4] == "model"
        assert sorted(order[5:-1]) == ["pwm0", "pwm1"], number
        assert order[-1] == "outputs"
    levels = [value for _, what, value in found if what == "cycle"]
    assert levels == [k % 2 ^ 1 for k in range(100)], "one toggle per cycle"


def test_probes_of_topics(robot: Path, tmp_path: Path) -> None:
    events = ["0.0101,pan_subscriber,0.5", "0.0202,tilt_subscriber,0.5", "0.0303,pan_subscriber,0.25"]
    found = signals(robot, tmp_path, 0.1, *events)
    arrived = [(time, value) for time, what, value in found if what == "setpoint"]
    assert [value for _, value in arrived] == [1, 0]
    assert [round(time / 1e6) for time, _ in arrived] in ([10, 30], [11, 31])
    assert [round(time / 1e6) for time, what, _ in found if what == "position"] == [0, 33, 66, 99]
