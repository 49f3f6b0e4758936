# SPDX-License-Identifier: Apache-2.0
"""Every component kind with its conversions, from setpoint file to plant and back, with sanitizers."""

from __future__ import annotations

import csv
import json
import math
import subprocess

import pytest

from tests.cmake.project import Project

SETPOINTS = """time,topic,value
0.05,speed,57.29577951308232
0.05,/level,1
0.10,arm,1
0.15,/level,3
0.20,arm,0
0.3,/level,100
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[list[dict[str, float]], dict[str, object], str]:
    """The trace by millisecond, statistics and published values of one run."""
    project = Project(tmp_path_factory.mktemp("all_kinds"), "all_kinds")
    project.configure()
    project.build()
    folder = project.build_folder
    (folder / "in.csv").write_text(SETPOINTS)
    files = ["--setpoints", "in.csv", "--trace", "out.csv", "--topics", "topics.csv", "--statistics", "out.json"]
    subprocess.run([folder / "robot_host", "--quiet", "--duration", "0.6", *files], cwd=folder, check=True)
    with (folder / "out.csv").open(newline="") as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
    return rows, json.loads((folder / "out.json").read_text()), (folder / "topics.csv").read_text()


def at(run: tuple[list[dict[str, float]], object, str], time: float, signal: str) -> float:
    return run[0][round(time * 1000)][signal]


def test_encoder_in_degrees_through_gear_counts_and_inversion(run) -> None:  # type: ignore[no-untyped-def]
    count = 360 / (4000 * 2.5)
    for time in (0.02, 0.1, 0.14):
        assert at(run, time, "inputs.angle") == pytest.approx(at(run, time, "plant.outputs.angle"), abs=count)


def test_reset_loads_the_preset_in_the_next_cycle_and_loses_no_counts(run) -> None:  # type: ignore[no-untyped-def]
    assert at(run, 0.150, "outputs.reset") == 1
    assert at(run, 0.150, "inputs.angle") == pytest.approx(54.0, abs=0.04)
    for time in (0.151, 0.2, 0.39):
        turned = at(run, time, "plant.outputs.angle") - at(run, 0.150, "plant.outputs.angle")
        assert at(run, time, "inputs.angle") == pytest.approx(90 + turned, abs=0.04)


def test_subscriber_units_initial_value_rate_limit_and_timeout(run) -> None:  # type: ignore[no-untyped-def]
    assert at(run, 0.0, "inputs.speed") == pytest.approx(math.pi / 2)
    assert at(run, 0.058, "inputs.speed") == pytest.approx(math.radians(90 - 9), abs=math.radians(1.01))
    assert at(run, 0.098, "inputs.speed") == pytest.approx(1.0)
    assert at(run, 0.130, "inputs.speed") == pytest.approx(math.radians(57.3 - 30), abs=math.radians(2))
    assert at(run, 0.2, "inputs.speed") == 0.0
    assert run[1]["setpoint_timeouts"] == 1


def test_a_topic_of_truth_values_feeds_a_boolean_input(run) -> None:  # type: ignore[no-untyped-def]
    for time, value in ((0.05, 0), (0.15, 1), (0.25, 0)):
        assert at(run, time, "inputs.armed") == value
        assert at(run, time, "outputs.armed_out") == value


def test_conversions_on_component_and_wire(run) -> None:  # type: ignore[no-untyped-def]
    assert at(run, 0.1, "inputs.level") == (3 * 1 + 1) / 4 - 0.5
    assert at(run, 0.2, "inputs.level") == 10 / 4 - 0.5
    assert at(run, 0.35, "inputs.level") == 10 / 4 - 0.5, (
        "a value outside of the limits of component and wire is refused"
    )
    assert run[1]["setpoints_dropped"] == 1
    assert at(run, 0.2, "inputs.offset") == -2.5
    assert run[1]["clamped"] > 0


def test_actuators_limits_and_steps(run) -> None:  # type: ignore[no-untyped-def]
    assert at(run, 0.05, "plant.inputs.duty") == 0.4, "max_duty 0.5, then the plant's own limit"
    assert at(run, 0.1, "plant.inputs.heat") == pytest.approx(0.5, abs=1e-3)
    assert at(run, 0.1, "plant.inputs.lamp") == 0
    assert at(run, 0.3, "plant.inputs.lamp") == 1


def test_the_model_runs_every_second_cycle(run) -> None:  # type: ignore[no-untyped-def]
    assert at(run, 0.390, "outputs.angle_out") == at(run, 0.391, "outputs.angle_out")
    assert at(run, 0.390, "outputs.angle_out") != at(run, 0.392, "outputs.angle_out")


def test_fail_safe_makes_every_actuator_safe_within_a_cycle_and_latches(run) -> None:  # type: ignore[no-untyped-def]
    assert at(run, 0.399, "enabled") == 1
    for time in (0.401, 0.599):
        assert at(run, time, "enabled") == 0
        assert at(run, time, "plant.inputs.duty") == 0
        assert at(run, time, "plant.inputs.heat") == pytest.approx(0.25, abs=1e-3)
        assert at(run, time, "plant.inputs.lamp") == 1
    assert run[1]["fault"] == "fail-safe"
    assert at(run, 0.599, "inputs.angle") > at(run, 0.4, "inputs.angle"), "sensors stay live"


def test_published_in_radians_every_10_ms(run) -> None:  # type: ignore[no-untyped-def]
    rows = list(csv.DictReader(run[2].splitlines()))
    assert len(rows) in (59, 60)
    assert {row["topic"] for row in rows} == {"position"}
    last = float(rows[-1]["value"])
    assert last == pytest.approx(math.radians(at(run, 0.59, "outputs.angle_out")), abs=1e-9)
