# SPDX-License-Identifier: Apache-2.0
"""The host platform as a program of Windows, under Wine; and compiled for macOS.

Wine's clock is that of Linux, but not its timers: the tests look at what is counted, and not at how late it is.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from epg.live.client import Client
from epg.live.udp import UdpPort
from tests.checkout import ROOT
from tests.doubles.toolchain import skip_if_missing, xrce_libraries
from tests.doubles.xrce_agent import Agent, PtyLink, float64, read_float64
from tests.platforms.host.program import PROGRAMS, WARNINGS, include_folders, platform_sources
from tests.windows.computer import GCC, MISSING, Computer, is_here

needs_wine = pytest.mark.skipif(not is_here(), reason=MISSING)
MACH_O = b"\xcf\xfa\xed\xfe"
"""The first bytes of a program of macOS."""

needs_zig = pytest.mark.skipif(
    importlib.util.find_spec("ziglang") is None, reason="ziglang is not installed: pip install ziglang"
)


def options(system: str) -> list[str]:
    defines = ["-DEPG_HOST_TARGET=epg_host_application", "-D_POSIX_C_SOURCE=200809L", "-D_DARWIN_C_SOURCE"]
    return ["-std=c11", *WARNINGS, *defines, *(f"-I{folder}" for folder in include_folders(system))]


def cmake(*words: str) -> None:
    done = subprocess.run(["cmake", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and "warning" not in done.stderr.lower(), done.stderr


def to_windows(project: str, folder: Path) -> tuple[str, ...]:
    """CMake's words that configure a project for Windows, with the compiler of Debian."""
    settings = ("-DCMAKE_SYSTEM_NAME=Windows", f"-DCMAKE_C_COMPILER={GCC}", f"-DPython3_EXECUTABLE={sys.executable}")
    return "-S", str(ROOT / project), "-B", str(folder), *settings


def build(project: str, folder: Path) -> Path:
    """JIWY, built by CMake of this computer for Windows."""
    cmake(*to_windows(project, folder))
    cmake("--build", str(folder), "-j2", "--target", "jiwy_host")
    return folder / "jiwy_host.exe"


@pytest.fixture(scope="module")
def program(computer: Computer) -> Path:
    return build("examples/jiwy", computer.folder / "build")


@needs_wine
def test_it_compiles_without_a_warning(tmp_path: Path) -> None:
    sources = [PROGRAMS / "motor.c", *platform_sources(system="windows")]
    command = [GCC, *options("windows"), "-fsyntax-only", *map(str, sources)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@needs_wine
def test_simulated_time(computer: Computer, program: Path, tmp_path: Path) -> None:
    done = computer.run(program, "--duration", "2", "--statistics", tmp_path / "statistics.json")
    assert done.returncode == 0, done.stderr
    statistics = json.loads((tmp_path / "statistics.json").read_text())
    assert (statistics["mode"], statistics["cycles"], statistics["missed"]) == ("simulated", 2000, 0)


@needs_wine
def test_real_time(computer: Computer, program: Path, tmp_path: Path) -> None:
    """Each tick is a cycle or is counted as missed; lateness is measured."""
    done = computer.run(program, "--realtime", "--duration", "2", "--statistics", tmp_path / "statistics.json")
    assert done.returncode == 0, done.stderr
    statistics = json.loads((tmp_path / "statistics.json").read_text())
    assert (statistics["mode"], statistics["scheduler"]) == ("realtime", "TIME_CRITICAL")
    assert statistics["cycles"] + statistics["missed"] == 2000
    assert statistics["cycles"] > 200
    assert 0 < statistics["lateness_mean"] < 1
    assert 2 <= statistics["wall_time"] < 4


@needs_wine
def test_the_console_on_standard_input(computer: Computer, program: Path) -> None:
    """Commands are answered, and the end of the input ends the program."""
    process = computer.start(program, "--realtime", "--console", stdin=subprocess.PIPE)
    output, errors = process.communicate("version\nstats\n", timeout=60)
    assert process.returncode == 0, errors
    assert "ok version" in output and "ok stats" in output
    assert errors == ""


@needs_wine
def test_the_console_by_udp(computer: Computer, program: Path) -> None:
    """A program of Linux uses the target.  The second one is told that the port is taken."""
    process = computer.start(program, "--realtime", "--console-udp", "127.0.0.1:0", "--duration", "20")
    assert process.stderr is not None
    line = process.stderr.readline()
    address = line.strip().rpartition("udp:127.0.0.1:")[2]
    second = computer.run(program, "--realtime", "--console-udp", f"127.0.0.1:{address}")
    assert "another program uses this port" in second.stderr, second.stderr
    with UdpPort(Path(f"udp:127.0.0.1:{address}")) as port:
        client = Client(port)
        try:
            assert client.description.name == "jiwy"
            assert any(word.startswith("cycles=") for answer in client.command("stats") for word in answer.split())
        finally:
            client.stop()
    process.kill()
    threading.Thread(target=process.communicate).start()


@needs_wine
def test_a_model_that_is_initialised_again(computer: Computer) -> None:
    """Its second run is the first: the variables of C and C++ are found in object files of Windows."""
    folder = computer.folder / "restart"
    places = (f"-DEXAMPLES={ROOT / 'examples'}", f"-DWORN={ROOT / 'tests/models/worn'}", f"-DEPG_DIR={ROOT / 'cmake'}")
    cpp = (f"-DCMAKE_CXX_COMPILER={GCC.replace('gcc', 'g++')}", "-DCMAKE_EXE_LINKER_FLAGS=-static")
    cmake(*to_windows("tests/cmake/projects/restart", folder), *places, *cpp)
    cmake("--build", str(folder), "-j2", "--target", "twice")
    done = computer.run(folder / "twice.exe")
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(done.stdout.splitlines()) == 2


@needs_wine
def test_there_is_no_pseudo_terminal(computer: Computer, program: Path) -> None:
    done = computer.run(program, "--realtime", "--console-pty", "port")
    assert done.returncode == 1
    assert done.stderr.splitlines() == [
        "port: error: Windows has no pseudo-terminals",
        "hint: --console-udp 127.0.0.1:7000",
    ]


@needs_wine
def test_an_agent_at_a_serial_port(computer: Computer) -> None:
    """COM8 is a terminal of this computer.  JIWY follows a setpoint of ROS 2, and tells its agent that it ends."""
    skip_if_missing(xrce_libraries)
    node = build("tests/middlewares/xrce/jiwy", computer.folder / "node")
    link = PtyLink(computer.folder / "line")
    with Agent(link) as agent:
        computer.connect("com8", link.path)
        process = computer.start(node, "--realtime", "--duration", "20", "--serial-device", "COM8")
        agent.topics.wait_for_reader("rt/pan_subscriber")
        agent.topics.wait_for_sample("rt/pan_publisher")
        agent.topics.publish("rt/pan_subscriber", float64(0.5))
        agent.wait_until(lambda: abs(read_float64(agent.topics.newest("rt/pan_publisher")) - 0.5) < 0.02)
        errors = process.communicate(timeout=60)[1]
        agent.wait_until(lambda: not agent.clients)
    assert (process.returncode, errors, link.broken) == (0, "jiwy: connected to the agent at COM8\n", 0)


@needs_zig
@pytest.mark.parametrize("machine", ["aarch64-macos", "x86_64-macos"])
def test_it_compiles_for_macos(machine: str, tmp_path: Path) -> None:
    """All of it: real time, the console on standard input, by a pseudo-terminal and by UDP, and agents."""
    sources = [PROGRAMS / "motor.c", *platform_sources(system="macos")]
    command = [sys.executable, "-m", "ziglang", "cc", "-target", machine, *options("macos"), *map(str, sources)]
    done = subprocess.run([*command, "-o", str(tmp_path / "motor")], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "motor").read_bytes()[:4] == MACH_O
