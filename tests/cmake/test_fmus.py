# SPDX-License-Identifier: Apache-2.0
"""FMUs in epg_add_model and epg_add_target."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.cmake.project import ROOT, Project, compiled, snapshot
from tests.models.fmus import FMU2, changed, pack

ARCHIVE = "model of pan/servo.fmu"


def project(folder: Path) -> Project:
    made = Project(folder, "fmus")
    pack(FMU2, made.source / ARCHIVE)
    no_mode = ('name="mode" valueReference="0" causality="input"', 'name="mode" valueReference="0" causality="local"')
    fmu = changed(FMU2, folder / "no_mode", "modelDescription.xml", no_mode)
    pack(fmu, made.source / "controller/servo.fmu")
    return made


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Project:
    made = project(tmp_path_factory.mktemp("fmus"))
    made.configure(f"-DFMUS={ROOT / 'tests/models'}")
    before = snapshot(made.source)
    made.build()
    assert snapshot(made.source) == before
    return made


def test_side_by_side(built: Project) -> None:
    done = subprocess.run([built.build_folder / "together"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines() == ["1 0 100 100", "1 1 1"]


def test_in_a_target(built: Project) -> None:
    """The period is the step of the FMU."""
    command = [built.build_folder / "servo_host", "--duration", "0.2"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "200" in done.stdout


def test_the_console_offers_what_can_be_changed(built: Project) -> None:
    """A fixed parameter cannot be changed after the start."""
    table = (built.build_folder / "epg/servo/servo_app.c").read_text().partition("parameter_table[] = {")[2]
    names = re.findall(r'\.name = "([^"]+)"', table.partition("};")[0])
    assert names == ["PI.kp", "PI.ki"]


def test_a_changed_archive_is_unpacked_and_compiled_again(built: Project, tmp_path: Path) -> None:
    """Only files that have changed in the archive are compiled; without a change, no file is."""
    assert compiled(built.build()) == set()
    fmu = changed(FMU2, tmp_path / "fmu", "sources/law.c", ("limit(duty);", "limit(0.5 * duty);"))
    path = pack(fmu, built.source / ARCHIVE)
    later = path.stat().st_mtime + 2
    os.utime(path, (later, later))
    others = {"servo_version.c", "servo_app.c", "pan_export_variables.c", "servo_model_export_variables.c"}
    assert {"law.c"} <= compiled(built.build()) <= {"law.c", *others}
    done = subprocess.run([built.build_folder / "together"], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[0] == "0 0 100 100"


def alone(folder: Path, *changes: tuple[str, str, str]) -> Project:
    """A project with one FMU in a folder.  A change is a file of the FMU, an old and a new text."""
    made = Project(folder, "fmu_alone")
    shutil.copytree(FMU2, made.source / "servo")
    for file, old, new in changes:
        made.edit(f"servo/{file}", old, new)
    return made


def errors(output: str) -> list[str]:
    return re.findall(r": error: (.+)", output)


def test_a_function_that_only_the_linker_misses(tmp_path: Path) -> None:
    """It is one error while CMake configures, at the call, with the user's own names."""
    call = "duty = kp * sum / law->size + law->integral;"
    made = alone(tmp_path, ("sources/law.c", call, call.replace("kp", "kp * gain_of_table(1) / other_gain(2)")))
    output = made.fails_to_configure()
    assert errors(output) == [
        "'gain_of_table' is called, but neither a source of the model nor the C library defines it (nor 'other_gain')"
        " [model-incomplete]"
    ]
    assert re.search(r"servo/sources/law\.c:22:\d+: error", output)
    assert "EPG: model 'servo' cannot run on this target" in output
    assert errors(made.configure(check=False)), "it is reported again until it is mended"
    made.edit("servo/sources/law.c", " * gain_of_table(1) / other_gain(2)", "")
    assert errors(made.configure()) == []


def test_sources_that_do_not_compile_are_one_error(tmp_path: Path) -> None:
    header = "#include <header_of_another_system.h>\n"
    made = alone(
        tmp_path, *((f"sources/{name}.c", '#include "law.h"', f'{header}#include "law.h"') for name in ("law", "servo"))
    )
    (message,) = errors(made.fails_to_configure())
    assert message.startswith("header_of_another_system.h: ") and "(2 files do not compile) [model-compile]" in message


def test_the_model_is_linked_again_only_after_a_change(tmp_path: Path) -> None:
    made = alone(tmp_path)
    made.configure()
    record = made.build_folder / "CMakeFiles/epg/servo.link.txt"
    before = record.stat().st_mtime_ns
    made.configure()
    assert record.stat().st_mtime_ns == before
    made.edit("servo/sources/law.c", "double sum = 0.0;", "double sum = 0.5;")
    made.configure()
    assert record.stat().st_mtime_ns > before


def test_the_model_is_linked_again_after_an_update_of_the_compiler(tmp_path: Path) -> None:
    """The program that CMake starts has changed, or the one that it starts has another version."""
    inner, outer = tmp_path / "inner", tmp_path / "outer"

    def write(script: Path, text: str) -> None:
        script.write_text(f"#!/bin/sh\n{text}\n")
        script.chmod(0o755)

    write(inner, 'exec cc "$@"')
    write(outer, f'exec "{inner}" "$@"')
    made = alone(tmp_path)
    made.configure(f"-DCMAKE_C_COMPILER={outer}")
    record = made.build_folder / "CMakeFiles/epg/servo.link.txt"
    times = [record.stat().st_mtime_ns]
    for update in (
        lambda: None,
        lambda: write(outer, f'exec "{inner}" "$@" # newer'),
        lambda: write(inner, '[ "$1" = --version ] && echo cc 99.0 && exit\nexec cc "$@"'),
        lambda: None,
    ):
        update()
        made.configure()
        times.append(record.stat().st_mtime_ns)
    assert times[0] == times[1] < times[2] < times[3] == times[4]


@pytest.mark.skipif(
    not shutil.which("arm-none-eabi-gcc"),
    reason="arm-none-eabi-gcc is not installed: sudo apt install gcc-arm-none-eabi libnewlib-arm-none-eabi",
)
def test_the_memory_on_a_microcontroller(tmp_path: Path) -> None:
    """The heap is part of the RAM; a large array makes it larger by its size."""
    made = alone(tmp_path)
    toolchain = ["-DCMAKE_SYSTEM_NAME=Generic", "-DCMAKE_C_COMPILER=arm-none-eabi-gcc"]
    toolchain += ["-DCMAKE_TRY_COMPILE_TARGET_TYPE=STATIC_LIBRARY", "-DCMAKE_C_FLAGS=-mcpu=cortex-m33 -mthumb -Os"]

    def memory(output: str) -> tuple[float, float]:
        (found,) = re.findall(r"'servo' needs ([\d.]+) KiB of flash and ([\d.]+) KiB of RAM", output)
        return float(found[0]), float(found[1])

    flash, ram = memory(made.configure(*toolchain))
    assert 1 < flash < 64 and 15.9 < ram < 32
    assert memory(made.configure()) == (flash, ram), "it is printed again"
    made.edit(
        "servo/sources/law.c", "double sum = 0.0;", "static double table[4096];\n    double sum = table[law->next]++;"
    )
    assert 31.8 < memory(made.configure())[1] - ram < 32.2
