# SPDX-License-Identifier: Apache-2.0
"""Systems in simulated time: each target does what it does alone; messages and clocks are as the file says."""

from __future__ import annotations

import csv
import json
import shutil
import struct
import subprocess
from bisect import bisect_left
from itertools import pairwise
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator.diagnostics import UserError
from epg.simulate import format_table, simulate, simulate_system
from tests.cmake.project import ROOT, Project, copy_jiwy

SYSTEM = """version: 1
system: robots
targets:
  leader:
    tcf: rpi_pico_freertos_jiwy
    model: model
    bindings: jiwy.bindings.yaml
    plant: plant
    plant_bindings: plant.bindings.yaml
    set: {components: {tilt_publisher: {on_change: true}}}
  near:
    tcf: nucleo_h743zi_freertos_jiwy
    model: model
    bindings: jiwy.bindings.yaml
    clock: {start: 0.3 ms, drift: 200}
    set: {components: {pan_subscriber: {limits: [-4, 4]}, tilt_subscriber: {limits: [-4, 4]}}} # also while it homes
  far:
    tcf: rpi_pico2_zephyr_jiwy
    model: model
    bindings: jiwy.bindings.yaml
    count: 2
    clock: {drift: -100}
    set: {components: {pan_subscriber: {limits: [-4, 4]}, tilt_subscriber: {limits: [-4, 4]}}}
  drive: {tcf: rpi_pico_bare_metal_relbot, model: relbot/model, bindings: relbot/relbot.bindings.yaml}
connections:
  - {from: leader/pan_publisher, to: near/pan_subscriber, delay: 2 ms}
  - {from: leader/pan_publisher, to: far/pan_subscriber, qos: best_effort, delay: 5 ms, jitter: 50 ms, loss: 0.2}
  - {from: leader/tilt_publisher, to: far/tilt_subscriber, qos: reliable, type: float32, loss: 0.2}
  - {from: leader/tilt_publisher, to: near/tilt_subscriber, qos: reliable, type: float32, delay: 0 ms}
world: {sends: [leader/pan_subscriber, leader/tilt_subscriber, drive/left_subscriber, drive/right_subscriber]}
"""
LISTS = """cmake_minimum_required(VERSION 3.22)
project(robots LANGUAGES C CXX)
find_package(EPG REQUIRED)
epg_add_system(robots SYSTEM robots.system.yaml)
epg_add_simulation(judged EXECUTABLE robots SCENARIO follow.yaml OUTPUT judged)
epg_add_target(alone TCF host_jiwy.tcf MODEL model BINDINGS jiwy.bindings.yaml
  PLANT plant PLANT_BINDINGS plant.bindings.yaml)
epg_add_executable(alone_host EPG::alone)
"""
SETPOINTS = """time,topic,value
0,$enable,1
8,{pan},0.4
9,{tilt},-0.2
"""
SECONDS = 10.0
SCENARIO = """version: 1
duration: 8 s
setpoints:
  leader/pan_subscriber: {profile: [{shape: move, start: 5 s, duration: 2 s, to: 0.5 rad}]}
  leader/tilt_subscriber: {}
events:
  - {at: 0 s, enable: true, target: leader}
  - {at: 0 s, enable: true, target: near}
  - {at: 7.5 s, failure: hang, target: far_1}
  - {at: 2 s, failure: die, target: drive}
  - {at: 3 s, failure: restart, target: drive}
  - {at: 5.5 s, lost: 0.2 s}
ends: {far_2: never_enabled, drive: never_enabled}
axes:
  leader:
    setpoint: leader/pan_subscriber
    position: leader/plant.outputs.angle_pan
    duty: near/outputs.pwm_pan
    windows: [{from: 5 s, until: 8 s, rms: 0.05 rad}]
  near:
    setpoint: leader/outputs.pan_logging
    position: near/inputs.setpoint_pan
    windows: [{from: 5 s, until: 8 s, largest: 0.1 rad}]
"""


def project_in(folder: Path) -> Project:
    project = Project(folder, "robots")
    copy_jiwy(project.source, "model", "plant")
    shutil.copytree(ROOT / "examples/relbot", project.source / "relbot")
    (project.source / "robots.system.yaml").write_text(SYSTEM)
    (project.source / "follow.yaml").write_text(SCENARIO)
    (project.source / "CMakeLists.txt").write_text(LISTS)
    return project


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Project:
    project = project_in(tmp_path_factory.mktemp("system"))
    project.configure()
    project.build()
    return project


def run(project: Project, folder: Path, *options: str) -> Path:
    """The folder with the files of a run."""
    folder.mkdir()
    names = {"pan": "/robots/leader/pan_subscriber", "tilt": "/robots/leader/tilt_subscriber"}
    (folder / "leader.in").write_text(SETPOINTS.format(**names))
    (folder / "near.in").write_text("time,topic,value\n0,$enable,1\n")
    command: list[str | Path] = [project.build_folder / "robots", "--duration", str(SECONDS), "--trace", folder]
    command += ["--topics", folder / "topics.csv", "--setpoints", f"leader={folder / 'leader.in'}"]
    command += ["--setpoints", f"near={folder / 'near.in'}", *options]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder


@pytest.fixture(scope="module")
def files(built: Project, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(built, tmp_path_factory.mktemp("run") / "first")


def rows(file: Path) -> list[dict[str, str]]:
    with file.open(newline="") as text:
        return list(csv.DictReader(text))


def sent(files: Path, topic: str) -> list[tuple[float, float]]:
    return [(float(row["time"]), float(row["value"])) for row in rows(files / "topics.csv") if row["topic"] == topic]


def test_a_target_does_what_it_does_alone(built: Project, files: Path) -> None:
    setpoints, trace = files / "alone.in", files / "alone.csv"
    setpoints.write_text(SETPOINTS.format(pan="pan_subscriber", tilt="tilt_subscriber"))
    program = built.build_folder / "alone_host"
    options: list[str | Path] = ["--quiet", "--duration", str(SECONDS), "--setpoints", setpoints, "--trace", trace]
    subprocess.run([program, *options], check=True)
    assert trace.read_bytes() == (files / "leader.csv").read_bytes()
    assert abs(float(rows(trace)[-1]["inputs.position_pan"]) - 0.4) < 0.01, "the robot has moved"


def test_late_cycles(built: Project, tmp_path: Path) -> None:
    """Two targets are stalled at the same time.  The leader does the same as alone."""
    stalls = "0.1,{stall}0.0004\n8.2,{stall}0.0132\n8.2125,{stall}0.002\n8.2131,{stall}0.003\n9.9991,{stall}0.1\n"
    events = tmp_path / "events.csv"
    ofleader = stalls.format(stall="leader,stall ")
    events.write_text(f"time,target,event\n{ofleader}8.201,near,stall 0.05\n3,far_1,stall 0.2\n3.1,far_1,restart\n")
    files = run(built, tmp_path / "run", "--events", str(events))
    setpoints, trace, topics = (tmp_path / name for name in ("alone.in", "alone.csv", "topics.csv"))
    text = SETPOINTS.format(pan="pan_subscriber", tilt="tilt_subscriber") + stalls.format(stall="$stall,")
    setpoints.write_text(
        "\n".join(sorted(text.splitlines(), key=lambda row: float(row.split(",")[0].replace("time", "-1")))) + "\n"
    )
    options: list[str | Path] = ["--quiet", "--duration", str(SECONDS), "--setpoints", setpoints, "--trace", trace]
    subprocess.run([built.build_folder / "alone_host", *options, "--topics", topics], check=True)
    assert trace.read_bytes() == (files / "leader.csv").read_bytes()
    alone = [(float(row["time"]), float(row["value"])) for row in rows(topics) if row["topic"] == "pan_publisher"]
    assert alone == sent(files, "/robots/leader/pan_publisher")
    late = [(row["time"], row["computation"]) for row in rows(trace) if float(row["computation"]) > 0]
    assert late == [("0.1", "0.0004"), ("8.2", "0.0132"), ("8.213", "0.005")]
    ticks = [float(row["time"]) for row in rows(files / "near.csv")]
    gaps = [(before, after) for before, after in pairwise(ticks) if after - before > 0.0011]
    assert len(gaps) == 1 and 8.2 < gaps[0][0] < 8.203 and abs(gaps[0][1] - gaps[0][0] - 0.05) < 0.0011
    lives = [row for row in rows(files / "far_1.csv") if float(row["time"]) >= 2.9995]
    assert float(lives[0]["time"]) >= 3.1, "a cycle that is stalled ends with its life"


def test_equal_runs_and_other_seeds(built: Project, files: Path, tmp_path: Path) -> None:
    again, other = run(built, tmp_path / "again"), run(built, tmp_path / "other", "--seed", "1")
    for name in ("leader", "near", "far_1", "far_2"):
        assert (again / f"{name}.csv").read_bytes() == (files / f"{name}.csv").read_bytes()
    assert (other / "near.csv").read_bytes() == (files / "near.csv").read_bytes(), "this connection has no chance"
    assert (other / "far_1.csv").read_bytes() != (files / "far_1.csv").read_bytes()
    assert (files / "far_1.csv").read_bytes() != (files / "far_2.csv").read_bytes()


def test_ticks_are_those_of_the_targets_clock(files: Path) -> None:
    """Tick k is at start + k T / (1 + drift), however long the run is."""
    for name, start_ns, drift in (("near", 300_000, 200), ("far_1", 0, -100)):
        times = [round(float(row["time"]) * 1e9) for row in rows(files / f"{name}.csv")]
        assert times == [start_ns + number * 10**6 * 10**9 // (10**9 + 1000 * drift) for number in range(len(times))]
        assert times[-1] < SECONDS * 1e9 <= times[-1] + 1_001_000


def received(files: Path, name: str, axis: str) -> list[tuple[float, float]]:
    """The times at which a setpoint of a follower changes, with its new values."""
    found: list[tuple[float, float]] = []
    for row in rows(files / f"{name}.csv"):
        value = float(row[f"inputs.setpoint_{axis}"])
        if value != (found[-1][1] if found else 0.0):
            found.append((float(row["time"]), value))
    return found


def changes(messages: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The messages whose value differs from that of the message before."""
    before = 0.0
    found = []
    for time, value in messages:
        if value != before:
            found.append((time, value))
        before = value
    return found


def test_a_message_acts_in_the_first_cycle_after_its_delay(files: Path) -> None:
    messages = changes(sent(files, "/robots/leader/pan_publisher"))
    ticks = [float(row["time"]) for row in rows(files / "near.csv")]
    expected = [
        (ticks[at], value) for time, value in messages if (at := bisect_left(ticks, time + 0.002 - 1e-12)) < len(ticks)
    ]
    assert len(expected) > 20
    assert received(files, "near", "pan") == expected


EVENTS = """time,target,event
0,far_2,offline
0,drive,offline
3,drive,die
3,far_2,hang
4,far_2,restart
4.0005,drive,restart
6,leader,die
"""


@pytest.fixture(scope="module")
def failures(built: Project, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("failures")
    (folder / "events.csv").write_text(EVENTS)
    return run(built, folder / "run", "--events", str(folder / "events.csv"))


@pytest.mark.parametrize(("name", "end", "start"), [("far_2", 3.0, 4.0), ("drive", 3.0, 4.0005)])
def test_a_restart_is_a_first_start(name: str, end: float, start: float, failures: Path) -> None:
    """The code of the models is a C function and a C++ class: both have variables outside of functions."""
    lives: tuple[list[list[str]], list[list[str]]] = ([], [])
    for row in rows(failures / f"{name}.csv"):
        time = float(row.pop("time"))
        assert time < end or time >= start
        lives[time >= start].append(list(row.values()))
    shorter = min(map(len, lives))
    assert shorter > 2900
    assert lives[0][:shorter] == lives[1][:shorter]


def test_a_dead_target_sends_nothing(failures: Path, files: Path) -> None:
    for topic in ("pan", "tilt"):
        before, after = (sent(place, f"/robots/leader/{topic}_publisher") for place in (files, failures))
        assert after == [(time, value) for time, value in before if time < 6]
    assert received(failures, "near", "pan") == [(t, v) for t, v in received(files, "near", "pan") if t < 6.002]
    assert received(failures, "far_2", "pan") == [], "it is offline"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("time,target,event\n1,ledar,die\n", ":2: error: the system has no target of this name"),
        (
            "time,target,event\n1,leader,dies\n",
            ":2: error: an event is die, hang, restart, stall SECONDS, offline or online",
        ),
        (
            "time,target,event\n1,leader,die 1\n",
            ":2: error: an event is die, hang, restart, stall SECONDS, offline or online",
        ),
        ("time,target,event\n1,leader,stall 0\n", ":2: error: a stall needs its seconds: 'stall 0.02'"),
        ("time,target,event\n1,leader,stall\n", ":2: error: a stall needs its seconds: 'stall 0.02'"),
        ("time,target,event\n\nsoon,leader,die\n", ":3: error: the time must be a number of seconds"),
        ("time,target\n", ":1: error: the first line must be 'time,target,event'"),
        ("time,target,event\n1,leader\n", ":2: error: a line must have a time, a target and an event"),
        (f"time,target,event\n1,leader,{'x' * 300}\n", ":2: error: this line is too long"),
    ],
)
def test_wrong_events(text: str, told: str, built: Project, tmp_path: Path) -> None:
    path = tmp_path / "events.csv"
    path.write_text(text)
    command: list[str | Path] = [built.build_folder / "robots", "--duration", "1", "--events", path]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
    assert (done.returncode, done.stderr.strip()) == (2, f"{path}{told}")


def rounded(value: float) -> float:
    """The nearest number of a std_msgs/msg/Float32."""
    return float(struct.unpack("f", struct.pack("f", value))[0])


def test_publications_on_change(files: Path) -> None:
    """Without a delay, a change acts in the next cycle of a receiver, as the number that its message holds."""
    logged = [(float(row["time"]), float(row["outputs.tilt_logging"])) for row in rows(files / "leader.csv")]
    messages = sent(files, "/robots/leader/tilt_publisher")
    assert messages == [logged[0], *changes(logged)]
    ticks = [float(row["time"]) for row in rows(files / "near.csv")]
    places = [(bisect_left(ticks, time), rounded(value)) for time, value in changes(logged)]
    assert received(files, "near", "tilt") == [(ticks[at], value) for at, value in places if at < len(ticks)]


def test_lost_messages_are_lost_or_late(files: Path) -> None:
    sent_values, got = {}, {}
    for axis in ("pan", "tilt"):
        messages = changes(sent(files, f"/robots/leader/{axis}_publisher"))
        sent_values[axis] = [rounded(value) for _, value in messages]
        got[axis] = [rounded(value) for _, value in received(files, "far_1", axis)]
        left = iter(sent_values[axis])
        assert all(value in left for value in got[axis]), "a message never replaces a newer one"
    assert 0.3 < len(got["pan"]) / len(sent_values["pan"]) < 0.85
    assert got["tilt"] == sent_values["tilt"][: len(got["tilt"])] and len(got["tilt"]) > 50
    late = [at - time for (time, _), (at, _) in zip(messages, received(files, "far_1", "tilt"), strict=False)]
    assert min(late) < 0.0021 and max(late) > 0.003, "a lost message of a reliable topic comes again"


# Scenarios -----------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def judged(built: Project) -> Path:
    """The folder of a run through the scenario, by CMake."""
    assert "all 2 limits of the scenario hold" in built.build("--target", "judged")
    return built.build_folder / "judged"


def test_an_axis_is_judged_at_the_cycles_of_its_target(judged: Path) -> None:
    """The setpoint of the second axis is the newest value of a signal of another target, by another clock."""
    leader, near = rows(judged / "traces/leader.csv"), rows(judged / "traces/near.csv")
    times = [float(row["time"]) for row in leader]
    tracking = [row for row in rows(judged / "tracking.csv") if row["near_position"]]
    assert len(tracking) == len(near) and len(rows(judged / "tracking.csv")) > len(near)
    for row, own in zip(tracking, near, strict=True):
        newest = max(0, bisect_left(times, float(row["time"]) + 1e-12) - 1)
        assert row["time"] == own["time"] and float(row["near_position"]) == float(own["inputs.setpoint_pan"])
        assert float(row["near_setpoint"]) == float(leader[newest]["outputs.pan_logging"])
    assert {row["leader_duty"] for row in rows(judged / "tracking.csv")} == {
        "",  # this target had no cycle at this time
        *(repr(float(row["outputs.pwm_pan"])) for row in near),
    }


def test_the_events_of_a_scenario(judged: Path) -> None:
    states = json.loads((judged / "statistics.json").read_text())["targets"]
    assert {name: state["state"] for name, state in states.items() if state["state"] != "runs"} == {"far_1": "hangs"}
    assert [state["enabled"] for state in states.values()] == [True, True, False, False, False]
    assert float(rows(judged / "traces/far_1.csv")[-1]["time"]) < 7.5
    assert states["drive"]["cycles"] == 5000, "since its restart"
    setpoints = [
        float(row["time"]) for row in rows(judged / "setpoints.csv") if row["topic"].endswith("pan_subscriber")
    ]
    assert not [time for time in setpoints if 5.5 <= time < 5.7] and len(setpoints) == 243 - 6


def test_a_system_that_does_not_do_what_its_scenario_expects(built: Project, judged: Path, tmp_path: Path) -> None:
    text = SCENARIO.replace("{far_2: never_enabled", "{far_1: enabled").replace("rms: 0.05 rad", "rms: 0.001 rad")
    (tmp_path / "follow.yaml").write_text(text)
    result = simulate_system(built.build_folder / "robots", tmp_path / "follow.yaml", tmp_path / "out")
    table = format_table(result)
    assert not result.passed
    assert "FAILED: far_1: the target did not run at the end" in table
    assert "FAILED: far_2: the target was never enabled" in table
    assert "NOT HELD: leader: RMS error from 5 s to 8 s" in table
    for name in ("traces/leader.csv", "traces/far_2.csv", "topics.csv", "setpoints.csv", "statistics.json"):
        assert (tmp_path / "out" / name).read_bytes() == (judged / name).read_bytes(), "equal runs"


def test_only_simulated_time(built: Project, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    program, scenario = built.build_folder / "robots", built.source / "follow.yaml"
    assert main(["simulate", str(program), "--scenario", str(scenario), "--output", str(tmp_path), "--realtime"]) == 1
    assert "a system is simulated in simulated time only [needs-one-target]" in capsys.readouterr().err
    with pytest.raises(UserError):
        simulate(program, scenario, tmp_path)


def block(page: str, name: str) -> str:
    """The YAML of a page after the comment ``name``."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return text.partition(f"<!-- {name} -->")[2].partition("```yaml\n")[2].partition("```")[0]


def test_the_pages_system_and_scenario(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The file of the system is built by ``epg simulate``, and a mistake of the build is reported."""
    copy_jiwy(tmp_path, "model", "plant")
    (tmp_path / "two_jiwys.system.yaml").write_text(block("systems.md", "two jiwys"))
    (tmp_path / "follow.yaml").write_text(block("simulation.md", "scenario of two jiwys"))
    command = ["simulate", str(tmp_path / "two_jiwys.system.yaml"), "--scenario", str(tmp_path / "follow.yaml")]
    command += ["--output", str(tmp_path / "results")]
    assert main([*command, "--json"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["passed"] and len(data["checks"]) == 2
    assert {name: state["cycles"] for name, state in data["targets"].items()} == {"leader": 18000, "follower": 5000}
    assert all((tmp_path / "results" / file).is_file() for file in data["files"])
    model = tmp_path / "model/xxmodel.c"
    model.write_text(model.read_text() + "\n#error not today\n")
    assert main(command) == 1
    assert f"{model.name}:" in (told := capsys.readouterr().err) and "not today" in told
