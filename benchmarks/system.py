# SPDX-License-Identifier: Apache-2.0
"""Measures the simulation of systems: simulated time per second, and a control cycle beside a switch of processes.

Each target is a shared object in one program.  A process for each target, in lockstep, would add the time of a step of
`lockstep.c` to each cycle.
"""

from __future__ import annotations

import shutil
import statistics
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from measure import JIWY, ROOT, all_in_turns, run
from report import Table, arguments, command_line, show

BORDER = 1.0
"""Seconds of simulated time per second that the largest system must reach."""

SYSTEM = """version: 1
system: chain
targets:
  first: {{tcf: rpi_pico_freertos_jiwy, {files}}}
  next: {{tcf: rpi_pico2_bare_metal_jiwy, {files}, count: {others}}}
connections:
  - {{from: first/pan_publisher, to: next/pan_subscriber}}
  - {{from: first/tilt_publisher, to: next/tilt_subscriber}}
world: {{sends: [first/pan_subscriber, first/tilt_subscriber]}}
"""
FILES = {"model": "model", "bindings": "jiwy.bindings.yaml", "plant": "plant", "plant_bindings": "plant.bindings.yaml"}


def main() -> None:
    options = arguments(__doc__, rounds=5, targets=12, seconds=20, steps=200000)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        counts = sorted({2, options.targets})
        programs = {count: build(folder / str(count), count) for count in counts}
        commands = {
            f"{count} targets": partial(run, [program, "--duration", str(options.seconds)])
            for count, program in programs.items()
        }
        times = all_in_turns(commands, options.rounds)
        step_ns = lockstep(folder, options.steps)
    rows = []
    for count, (what, values) in zip(counts, times.items()):
        median = statistics.median(values)
        cycle_ns = median / options.seconds / count * 1e6  # 1000 cycles per second of each target
        rows.append([what, f"{options.seconds / median:.1f}", f"{cycle_ns:.0f}", f"{cycle_ns / step_ns:.2f} x"])
    rows.append(["a step of two processes, without a cycle", "", f"{step_ns:.0f}", "1.00 x"])
    reached = options.seconds / statistics.median(list(times.values())[-1])
    judged = "holds" if reached >= BORDER else "does not hold"
    note = f"Aim: {counts[-1]} targets with their plants at least in real time: {judged} ({reached:.1f} x)."
    head = ["what", "simulated s per s", "ns for each cycle", "of a step of two processes"]
    table = Table("Systems in simulated time (JIWY with its plant, 1 kHz)", head, rows, [note])
    show("system", [table], options.write, command_line("system"))


def build(folder: Path, count: int) -> Path:
    """The program that simulates a system of ``count`` targets."""
    folder.mkdir()
    for name in FILES.values():
        source = JIWY / name
        shutil.copytree(source, folder / name) if source.is_dir() else shutil.copy(source, folder / name)
    files = ", ".join(f"{key}: {name}" for key, name in FILES.items())
    (folder / "chain.system.yaml").write_text(SYSTEM.format(files=files, others=count - 1), encoding="utf-8")
    config = (ROOT / "cmake" / "EPGConfig.cmake").as_posix()
    lists = ["cmake_minimum_required(VERSION 3.22)", "project(chain LANGUAGES C CXX)", f'include("{config}")']
    lists += ["epg_add_system(chain SYSTEM chain.system.yaml)", ""]
    (folder / "CMakeLists.txt").write_text("\n".join(lists), encoding="utf-8")
    setting = ["-DCMAKE_BUILD_TYPE=Release", f"-DPython3_EXECUTABLE={sys.executable}"]
    run(["cmake", "-S", folder, "-B", folder / "build", *setting])
    run(["cmake", "--build", folder / "build", "--parallel", "2"])
    return folder / "build" / "chain"


def lockstep(folder: Path, steps: int) -> float:
    """The time in ns of one step of two processes."""
    source, program = Path(__file__).resolve().parent / "lockstep.c", folder / "lockstep"
    subprocess.run(["cc", "-O2", "-std=c11", "-o", program, source], check=True)
    return float(run([program, str(steps)]))


if __name__ == "__main__":
    main()
