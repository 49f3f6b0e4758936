# SPDX-License-Identifier: Apache-2.0
"""docs/any-firmware.md is correct: its files are compiled and run as printed there, with drivers of this computer."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.catalog.test_how_tos import follow, read, steps
from tests.doubles.toolchain import arm_gcc, skip_if_missing, tool

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
WARNINGS = ["-std=c11", "-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror"]


@pytest.fixture(scope="module")
def repository(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The repository of the page after its last command."""
    folder = tmp_path_factory.mktemp("any_firmware")
    controller = [step for step in steps(read("tutorial")[0]) if step.path.startswith("controller/")]
    (folder / "src").mkdir()
    shutil.copy(HERE / "c" / "board.c", folder / "src")
    page = steps(read("any-firmware")[0])
    follow(controller + [step for step in page if step.path] + [step for step in page if step.command], folder)
    return folder


def test_the_program_runs(repository: Path) -> None:
    """The console answers on the page's UART; the page's clock wraps without a missed or a late tick."""
    talk = "version\nwatch inputs.position\nwatch off\nenable\nsetpoint=-9\nstats\ndisable\n"
    done = subprocess.run([repository / "build/my_firmware"], input=talk, capture_output=True, text=True, timeout=60)
    assert "ok version name=turntable" in done.stdout
    assert "state enabled=1 fault=none" in done.stdout
    stats = dict(re.findall(r"^stat (\w+)=(\S+)$", done.stdout, re.MULTILINE))
    assert int(stats["cycles"]) > 50
    assert stats["missed"] == stats["overruns"] == stats["lines_dropped"] == "0"
    assert int(stats["lateness_max_ns"]) < 10_000
    # max_duty is 0.3; the motor is off at the end
    assert done.stderr == "watchdog=fed top=3199 compare=0 largest=960\n"


def test_the_stubs_say_which_pulls_the_pins_need(repository: Path) -> None:
    """The stub of an input returns the level of an open pin: with the stubs, this emergency stop is pressed."""
    stubs = (repository / "build/epg/turntable/turntable_drivers.stub").read_text(encoding="utf-8")
    function = stubs[stubs.index("components.emergency_stop") : stubs.index("turntable_console_receive")]
    assert "The pin needs a pull-up resistor" in function
    assert "bool turntable_emergency_stop_get(void)\n{\n    return true;\n}" in function


def test_a_build_by_make(repository: Path) -> None:
    """The page's Makefile with this computer's compiler, from nothing, and again after a change of the target."""
    if shutil.which("make") is None:
        pytest.skip("make is not installed: sudo apt install make")
    command = ["make", "CC=cc", "CPU="]
    environment = os.environ | {"EPG_PATH": str(ROOT), "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    for gain in ("value: 5", "value: 4"):
        file = repository / "controller" / "model.yaml"
        file.write_text(file.read_text(encoding="utf-8").replace("value: 5", gain), encoding="utf-8")
        subprocess.run(command, cwd=repository, env=environment, check=True, capture_output=True)
        program = [repository / "my_firmware.elf"]
        done = subprocess.run(program, input="get kp\n", capture_output=True, text=True, timeout=60)
        assert f"kp={gain[-1]}" in done.stdout


def test_the_clock_is_right_in_all_contexts(repository: Path, tmp_path: Path) -> None:
    runtime = ROOT / "targets" / "runtime" / "include"
    includes = [f"-I{folder}" for folder in (repository / "src", repository / "build/epg/turntable", runtime)]
    program = tmp_path / "clock"
    sources = [HERE / "c" / "clock_check.c", repository / "src" / "clock.c"]
    subprocess.run(["cc", *WARNINGS, *includes, *sources, "-o", program], check=True)
    done = subprocess.run([program], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout
    assert int(done.stdout.split()[0]) > 1000, "the counter has wrapped"


def test_all_code_is_clean_for_a_microcontroller(repository: Path, tmp_path: Path) -> None:
    skip_if_missing(arm_gcc, lambda: tool("freertos_kernel"))
    root = ROOT / "targets"
    kernel = tool("freertos_kernel")
    includes = [repository / "src", repository / "build/epg/turntable", root / "runtime/include"]
    system = [HERE / "c" / "freertos", kernel / "include", kernel / "portable/GCC/ARM_CM4F"]
    command = [str(arm_gcc()), "-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", *WARNINGS, "-c"]
    command += [f"-I{folder}" for folder in includes] + [f"-isystem{folder}" for folder in system]
    files = sorted((repository / "src").glob("*.c"))
    names = ["board.c", "clock.c", "main.c", "main_freertos.c", "turntable_drivers.c", "uart.c"]
    assert [file.name for file in files] == names
    for file in files[1:]:
        subprocess.run([*command, file, "-o", tmp_path / "object.o"], check=True)
