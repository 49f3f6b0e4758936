# SPDX-License-Identifier: Apache-2.0
"""JIWY in Zephyr on this computer: the host's numbers in simulated time; an agent and a console in real time."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from epg.simulate import simulate
from tests.doubles.toolchain import ROOT, Missing, arm_gcc, skip_if_missing, xrce_libraries
from tests.doubles.xrce_agent import Agent, PtyLink, UdpLink, float64
from tests.middlewares.client import Host, Lines, stat, values
from tests.middlewares.xrce.follow import PERIOD, follow
from tests.waiting import until

from .workspace import NATIVE, build, workspace
from .workspace import run as run_tool

PATIENCE = 30.0
SOURCE = ROOT / "tests" / "zephyr" / "native_sim"
TRACKING = ROOT / "examples" / "jiwy" / "tracking.yaml"
MEASURED = ("wall_time", "computation_min", "computation_mean", "computation_max")
"""Statistics that depend on a real clock."""

EVENTS = """time,topic,value
0,pan_subscriber,0
4.5,pan_subscriber,0.5
4.5,tilt_subscriber,0.2
4.75,$stall,0.0034
5,pan_subscriber,nan
5.2503,tilt_subscriber,0.3
5.5,$enable,0
5.6,$enable,1
5.7,$stall,0.02
5.999,$stall,0.0057
"""


@pytest.fixture(scope="module")
def folder() -> Path:
    """The build folder of tests/zephyr/native_sim."""
    skip_if_missing(lambda: workspace(NATIVE), arm_gcc, xrce_libraries)
    return build(SOURCE, NATIVE)


@pytest.fixture(scope="module")
def image(folder: Path) -> Path:
    return folder / "zephyr" / "zephyr.exe"


def test_flash_comes_with_the_store_only(folder: Path) -> None:
    """native_sim has a storage_partition, but the target keeps saved values in a file."""
    configuration = (folder / "zephyr" / ".config").read_text(encoding="utf-8").splitlines()
    assert "# CONFIG_EPG_STORE is not set" in configuration
    assert [line for line in configuration if line.startswith("CONFIG_FLASH") and line.endswith("=y")] == []


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same target on the platform host."""

    def needs() -> None:
        if not shutil.which("ninja"):
            raise Missing("Ninja is not installed: sudo apt install ninja-build")

    skip_if_missing(xrce_libraries, needs)
    folder = tmp_path_factory.mktemp("host")
    python = f"-DPython3_EXECUTABLE={sys.executable}"
    for command in (
        ["cmake", "-S", str(SOURCE / "host"), "-B", str(folder), "-G", "Ninja", python],
        ["cmake", "--build", str(folder)],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder / "jiwy_host"


@pytest.fixture
def agent() -> Iterator[Agent]:
    with Agent(UdpLink()) as made:
        yield made


def start(command: list[str]) -> subprocess.Popen[str]:
    """Like :func:`run`, for a program with which the test communicates while it runs."""
    here = Path(command[0]).parent
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=here)


def run(program: Path, *options: str, cwd: Path | None = None) -> tuple[int, str]:
    """Exit status and stderr.  The program's simulated flash is a file in the folder in which it runs."""
    here = cwd or program.parent
    done = subprocess.run([program, *options], capture_output=True, text=True, check=False, timeout=PATIENCE, cwd=here)
    return done.returncode, done.stderr


def statistics(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text())
    return {name: value for name, value in found.items() if name not in MEASURED}


# Simulated time -------------------------------------------------------------------------------------------------------


def test_a_scenario_has_the_hosts_numbers(folder: Path, host: Path, tmp_path: Path) -> None:
    """The same bits, over homing and the whole profile, with the target that epg_add_simulation() has made."""
    assert simulate(host, TRACKING, tmp_path).passed
    results = folder / "tracking"
    shutil.rmtree(results, ignore_errors=True)
    assert "all 12 limits of the scenario hold" in run_tool(["ninja", "-C", str(folder), "tracking"], workspace(NATIVE))
    for name in ("trace.csv", "topics.csv", "tracking.csv"):
        assert (results / name).read_bytes() == (tmp_path / name).read_bytes(), name
    assert statistics(results / "statistics.json") == statistics(tmp_path / "statistics.json")


def test_stalls_and_events_have_the_hosts_numbers(image: Path, host: Path, tmp_path: Path) -> None:
    setpoints = tmp_path / "in.csv"
    setpoints.write_text(EVENTS)
    for program in (host, image):
        folder = tmp_path / program.name
        folder.mkdir()
        files = [f"--{name}={folder / name}" for name in ("trace", "topics", "statistics")]
        assert run(program, "--duration=6", "--quiet", f"--setpoints={setpoints}", *files) == (0, "")
    for name in ("trace", "topics"):
        assert (tmp_path / host.name / name).read_bytes() == (tmp_path / image.name / name).read_bytes(), name
    found = statistics(tmp_path / image.name / "statistics")
    assert found == statistics(tmp_path / host.name / "statistics")
    assert found["missed"] > 0 and found["overruns"] > 0 and found["setpoints_dropped"] == 1


@pytest.mark.parametrize(
    ("options", "status", "message"),
    [
        (["--duration=fast"], 2, "error: --duration 'fast' is not a time in seconds above 0\n"),
        (["--agent=127.0.0.1:8888", "--duration=1"], 2, "error: --agent without --realtime\n"),
        (["--console", "--duration=1"], 2, "error: --console without --realtime\n"),
        (["--realtime", "--agent=127.0.0.1"], 2, "error: --agent '127.0.0.1' is not HOST:PORT\n"),
        (
            ["--realtime", "--agent=no.such.host.invalid:1"],
            1,
            "error: the agent's host 'no.such.host.invalid' was not found",
        ),
        (["--duration=1", "--trace=/no/such/folder/t"], 1, "/no/such/folder/t: error: cannot write this file: "),
        (["--duration=1", "--setpoints=wrong.csv"], 2, "wrong.csv:2: error: unknown topic 'roll'\n"),
        (["--duration=1", "--setpoints=pin.csv"], 2, "pin.csv:2: error: the target has no digital input 'pwm_pan'\n"),
    ],
)
def test_mistakes(image: Path, tmp_path: Path, options: list[str], status: int, message: str) -> None:
    (tmp_path / "wrong.csv").write_text("time,topic,value\n0,roll,1\n")
    (tmp_path / "pin.csv").write_text("time,topic,value\n0,$component:pwm_pan,1\n")
    found, errors = run(image, *options, cwd=tmp_path)
    assert found == status and errors.startswith(message), errors


# Real time ------------------------------------------------------------------------------------------------------------


def test_a_node_over_udp(image: Path, agent: Agent) -> None:
    """The node follows setpoints of the agent, also after the agent's restart, and reports if there is an agent."""
    command = [str(image), "--realtime", f"--agent={agent.address}"]
    with start(command) as process:
        try:
            assert process.stderr is not None
            assert process.stderr.readline() == f"jiwy: connected to the agent at {agent.address}\n"
            agent.topics.publish("rt/pan_subscriber", float64(0.5), reliable=False)
            agent.wait_until(lambda: len(agent.topics.samples("rt/pan_publisher")) > 3.5 / PERIOD)  # it is homing
            assert follow(agent, 2.5) < 0.12
            agent.kill()
            assert process.stderr.readline() == f"jiwy: lost the agent at {agent.address}\n"
            agent.start()
            assert process.stderr.readline() == f"jiwy: connected to the agent at {agent.address}\n"
            agent.topics.wait_for_reader("rt/pan_subscriber")
            assert follow(agent, 1.5) < 0.12
            process.terminate()
            assert process.wait(PATIENCE) == 130
        finally:
            process.kill()


def test_a_node_over_a_terminal(image: Path, tmp_path: Path) -> None:
    with Agent(PtyLink(tmp_path / "line")) as agent:
        command = [str(image), "--realtime", "--quiet", f"--serial-device={agent.address}"]
        with start(command) as process:
            try:
                agent.topics.wait_for_reader("rt/pan_subscriber")
                since = agent.topics.count
                agent.topics.wait_for_sample("rt/pan_publisher")
                time.sleep(1.0)  # this program tells no time
                count = len(agent.topics.samples("rt/pan_publisher", since))
                assert 20 <= count <= 40, "every 33 ms of real time"
                process.terminate()
                assert process.communicate(timeout=PATIENCE)[1] == ""
            finally:
                process.kill()


def test_console_on_standard_input_and_output(image: Path) -> None:
    with Host(image, "--quiet") as console:
        assert console.ask("pan_subscriber=0.1 tilt_subscriber=-2.5e-3") == ["ok setpoint"]
        assert console.ask("watch setpoint_pan setpoint_tilt") == ["ok watch"]
        wanted = {"inputs.setpoint_pan": 0.1, "inputs.setpoint_tilt": -0.0025}
        until(lambda: values(console.until("watch ")[-1]) == wanted)
        assert console.close() == (0, "")


def test_what_is_saved_is_there_at_the_next_start(image: Path, tmp_path: Path) -> None:
    store = f"--store={tmp_path / 'store'}"
    with Host(image, "--quiet", store) as console:
        assert console.ask("set Pan\\PID\\kp=0.1") == ["ok set"]
        assert console.ask("disable")[-1] == "ok disable"
        assert console.ask("save") == ["ok save values=1"]
        assert console.close() == (0, "")
    with Host(image, "--quiet", store) as console:
        assert console.ask("get Pan\\PID\\kp") == ["parameter Pan\\PID\\kp=0.1 generated=2.6", "ok get"]
    with Host(image, "--quiet") as console:
        console.ask("disable")
        assert console.ask("save") == ["error save this program was started without --store FILE"]


def test_console_on_a_terminal_and_an_interrupt(image: Path, tmp_path: Path) -> None:
    name, trace = tmp_path / "console", tmp_path / "trace.csv"
    command = [str(image), "--realtime", "--quiet", "--duration=60", f"--console-pty={name}", f"--trace={trace}"]
    with start(command) as process:
        try:
            until(name.exists)
            file = os.open(name, os.O_RDWR | os.O_NOCTTY)
            console = Lines(file, file)
            console.until("ready ")
            assert console.ask("disable") == ["ok disable"]
            until(lambda: int(stat(console.ask("stats"), "cycles")) > 200)
            os.close(file)
            process.send_signal(signal.SIGINT)
            assert process.communicate(timeout=PATIENCE)[1] == ""
            assert process.returncode == 130
        finally:
            process.kill()
    assert not name.is_symlink()
    rows = trace.read_text().splitlines()
    assert rows[0].startswith("time,") and len({row.count(",") for row in rows}) == 1 and len(rows) > 100


def test_the_simulators_own_end(image: Path, tmp_path: Path) -> None:
    """native_sim has its own option for the time of the end; the file contains the recording up to it."""
    trace = tmp_path / "trace.csv"
    assert run(image, "--no-rt", "-stop_at=2", "--duration=9", f"--trace={trace}")[0] == 0
    rows = trace.read_text().splitlines()
    assert 1900 < len(rows) <= 2001 and len({row.count(",") for row in rows}) == 1
