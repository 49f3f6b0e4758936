# SPDX-License-Identifier: Apache-2.0
"""The simulation of a system as a program of Windows, under Wine; of other systems; and built for macOS.

Whatever the system is, the program writes the files that Linux's program writes from the same inputs.
"""

from __future__ import annotations

import importlib
import os
import subprocess
from pathlib import Path

import pytest

from tests.cmake.project import Project, copy_jiwy, snapshot
from tests.platforms.host.program import HOST, TARGETS, WARNINGS, include_folders
from tests.windows.computer import GCC, Computer
from tests.windows.test_host_program import MACH_O, needs_wine, needs_zig

SIMULATED = TARGETS / "platforms/simulated"
SYSTEM = """version: 1
system: two
targets:
  leader:
    tcf: rpi_pico_freertos_jiwy
    model: model
    bindings: jiwy.bindings.yaml
    plant: plant
    plant_bindings: plant.bindings.yaml
  follower:
    tcf: nucleo_h743zi_bare_metal_jiwy
    model: model
    bindings: jiwy.bindings.yaml
    clock: {start: 0.3 ms, drift: 200}
    set: {components: {pan_subscriber: {limits: [-4, 4]}}} # also while the leader homes
connections:
  - {from: leader/pan_publisher, to: follower/pan_subscriber, qos: best_effort, delay: 5 ms, jitter: 50 ms, loss: 0.2}
world: {sends: [leader/pan_subscriber, leader/tilt_subscriber, follower/tilt_subscriber]}
"""
LISTS = """cmake_minimum_required(VERSION 3.22)
project(two LANGUAGES C)
find_package(EPG REQUIRED)
epg_add_system(two SYSTEM two.system.yaml)
"""
HOST_PROGRAM = """
epg_add_target(jiwy TCF host_jiwy.tcf MODEL model BINDINGS jiwy.bindings.yaml
  PLANT plant PLANT_BINDINGS plant.bindings.yaml)
epg_add_executable(jiwy_host EPG::jiwy)
"""
INPUTS = {
    "leader.in": "time,topic,value\n0,$enable,1\n5,/two/leader/pan_subscriber,0.4\n",
    "follower.in": "time,topic,value\n0,$enable,1\n",
    # Two cycles are stalled at the same time, and one at the end of its life.
    "events.csv": "time,target,event\n5.2,leader,stall 0.013\n5.201,follower,stall 0.05\n"
    "5.4,follower,stall 0.2\n5.5,follower,restart\n5.6,leader,die\n5.7,leader,restart\n",
}
OPTIONS = ("--duration", "6", "--setpoints", "leader=leader.in", "--setpoints", "follower=follower.in")
OUTPUTS = ("--events", "events.csv", "--trace", ".", "--topics", "topics.csv", "--statistics", "statistics.json")


def built(folder: Path, *settings: str, more: str = "") -> Project:
    """A project with two JIWYs, which was built without a warning of the compiler.  EPG's models have none: `-w`."""
    project = Project(folder, "two")
    copy_jiwy(project.source, "model", "plant")
    (project.source / "two.system.yaml").write_text(SYSTEM)
    (project.source / "CMakeLists.txt").write_text(LISTS + more)
    project.configure(f"-DCMAKE_C_FLAGS={' '.join(WARNINGS)}", *settings)
    output = project.build("-j2")
    assert "warning:" not in output, output
    return project


@pytest.fixture(scope="module")
def linux(tmp_path_factory: pytest.TempPathFactory) -> Project:
    return built(tmp_path_factory.mktemp("linux"))


@pytest.fixture(scope="module")
def files(linux: Project, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """The files after a run on Linux."""
    folder = with_inputs(tmp_path_factory.mktemp("run"))
    subprocess.run([linux.build_folder / "two", *OPTIONS, *OUTPUTS], cwd=folder, check=True)
    found = snapshot(folder)
    assert {"leader.csv", "follower.csv", "topics.csv", "statistics.json"} < set(found)
    assert len(found["follower.csv"].splitlines()) > 5700
    return found


def with_inputs(folder: Path) -> Path:
    for name, text in INPUTS.items():
        (folder / name).write_text(text)
    return folder


def simulator_sources(*systems: str) -> list[Path]:
    """The sources of the program as platform.cmake lists them for a system, without the generated tables."""
    host = ("files/files.c", "files/number.c", "files/setpoints.c", "files/trace.c", "loop/diverged.c")
    folders = [SIMULATED / "simulator" / name for name in (".", *systems)]
    own = [source for folder in folders for source in sorted(folder.glob("*.c"))]
    return [*own, *(HOST / "src" / name for name in (*host, "program/interface.c"))]


def simulator_options() -> list[str]:
    folders = (SIMULATED / "include", SIMULATED / "simulator", *include_folders())
    return ["-std=c11", *WARNINGS, "-D_POSIX_C_SOURCE=200809L", *(f"-I{folder}" for folder in folders)]


@needs_wine
def test_windows(computer: Computer, files: dict[str, bytes], linux: Project, tmp_path: Path) -> None:
    """CMake of this computer builds for Windows."""
    program = built(tmp_path, "-DCMAKE_SYSTEM_NAME=Windows", f"-DCMAKE_C_COMPILER={GCC}").build_folder / "two.exe"
    (tmp_path / "run").mkdir()
    folder = with_inputs(tmp_path / "run")
    done = computer.run(program, *OPTIONS, *OUTPUTS, cwd=folder)
    assert (done.returncode, done.stderr) == (0, "")
    assert snapshot(folder) == files
    interface = subprocess.run([linux.build_folder / "two", "--interface"], capture_output=True, text=True, check=True)
    assert computer.run(program, "--interface").stdout.split() == interface.stdout.split()
    (program.parent / "two_follower_unit.so").rename(tmp_path / "away.so")
    done = computer.run(program, *OPTIONS, cwd=folder)
    missing = "two_follower_unit.so: error: cannot load this file beside the program: error 126 of Windows"
    assert (done.returncode, done.stderr.splitlines()) == (1, [missing])


def test_other_systems(linux: Project, files: dict[str, bytes], tmp_path: Path) -> None:
    """The sources for other systems of POSIX, on Linux: nothing stays in the folder for temporary files."""
    program, folder, temporary = linux.build_folder / "other", tmp_path / "run", tmp_path / "temporary"
    sources = [linux.build_folder / "epg/two/two_system.c", *simulator_sources("posix", "elsewhere")]
    libraries = [linux.build_folder / "libepg_communication.a", linux.build_folder / "libepg_runtime.a", "-ldl", "-lm"]
    command = ["gcc", "-O1", *simulator_options(), *map(str, [*sources, *libraries]), "-o", str(program)]
    subprocess.run(command, check=True)
    folder.mkdir()
    temporary.mkdir()
    environment = {**os.environ, "TMPDIR": str(temporary)}
    subprocess.run([program, *OPTIONS, *OUTPUTS], cwd=with_inputs(folder), env=environment, check=True)
    assert snapshot(folder) == files
    assert not list(temporary.iterdir())
    environment["TMPDIR"] = str(tmp_path / "none")
    done = subprocess.run([program, "--interface"], env=environment, capture_output=True, text=True, check=False)
    missing = "two_leader_unit.so: error: cannot load this file beside the program: No such file or directory\n"
    assert (done.returncode, done.stderr) == (1, missing)


@needs_zig
@pytest.mark.parametrize("machine", ["aarch64", "x86_64"])
def test_macos(machine: str, tmp_path: Path) -> None:
    """A system and a host program.  Zig's linker makes dynamic libraries, not bundles, and does not hide symbols."""
    zig = f'exec "{importlib.import_module("ziglang").__path__[0]}/zig"'
    bundle = 'words=("${@/#-bundle/-dynamiclib}")\nwords=("${words[@]/#-Wl,-exported_symbol,*/-Wl,-dead_strip}")\n'
    for name, text in {
        "cc": f'{bundle}{zig} cc -target {machine}-macos "${{words[@]}}"',
        "ar": f'{zig} ar "$@"',
        "ranlib": f'{zig} ranlib "$@"',
    }.items():
        (tmp_path / name).write_text(f"#!/usr/bin/env bash\n{text}\n")
        (tmp_path / name).chmod(0o755)
    tools = (
        f"-DCMAKE_{tool}={tmp_path / name}" for tool, name in (("C_COMPILER", "cc"), ("AR", "ar"), ("RANLIB", "ranlib"))
    )
    settings = ("-DCMAKE_SYSTEM_NAME=Darwin", f"-DCMAKE_SYSTEM_PROCESSOR={machine}", *tools)
    build = built(tmp_path, *settings, more=HOST_PROGRAM).build_folder
    for name in ("jiwy_host", "two", "two_leader_unit.so", "two_leader_plant_unit.so", "two_follower_unit.so"):
        assert (build / name).read_bytes()[:4] == MACH_O
