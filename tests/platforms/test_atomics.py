# SPDX-License-Identifier: Apache-2.0
"""Control and communication share words by loads and stores alone.

A Cortex-M0+ has no instructions that read, change and write a word at once.  There the compiler calls `__atomic_*`,
which the Pico SDK supplies by a spin lock: the control side would wait.  With LDREX and STREX, as other processors have
them, it would repeat.
"""

from __future__ import annotations

import json
import re
import shlex
import subprocess
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, arm_gcc, binutils, skip_if_missing
from tests.platforms.firmware.builds import HERE as FIRMWARE
from tests.platforms.firmware.builds import PROCESSORS, build
from tests.platforms.firmware.test_builds import XRCE
from tests.platforms.pico.images import PLATFORMS, images, skip_unless_buildable

CALL = re.compile(r"\b__(?:atomic|sync)_\w+")
EXCLUSIVE = re.compile(r"\b(?:ldrex|strex|ldaex|stlex)\w*\b")
CONTROL = ROOT / "targets" / "runtime" / "src" / "control"
ADD = "#include <stdatomic.h>\nvoid add(atomic_uint *to);\nvoid add(atomic_uint *to) { atomic_fetch_add(to, 1U); }\n"


def calls(file: Path) -> list[str]:
    """The functions of atomic operations that an object or the members of an archive need."""
    return [line for line in binutils("nm", "-uA", str(file)).splitlines() if CALL.search(line)]


def exclusives(file: Path) -> dict[str, list[str]]:
    """The exclusive accesses of each object in an archive."""
    found: dict[str, list[str]] = {}
    for line in binutils("objdump", "-d", str(file)).splitlines():
        member = re.match(r"(\S+):\s+file format", line)
        if member:
            found[member[1]] = here = []
        elif EXCLUSIVE.search(line):
            here.append(line.strip())
    return found


@pytest.mark.parametrize("name", ["m0plus", "m33", "m7"])
def test_what_is_forbidden_would_be_found(name: str, tmp_path: Path) -> None:
    skip_if_missing(arm_gcc)
    source, output = tmp_path / "add.c", tmp_path / "add.o"
    source.write_text(ADD, encoding="utf-8")
    command = [str(arm_gcc()), *PROCESSORS[name].options, "-mthumb", "-O2", "-c", str(source), "-o", str(output)]
    subprocess.run(command, check=True)
    assert (calls(output) != []) == (name == "m0plus")
    assert any(exclusives(output).values()) == (name != "m0plus")


@pytest.mark.parametrize("name", ["m0plus", "m33", "m7"])
def test_a_program_for_any_chip(name: str) -> None:
    """The runtime, the console, XRCE with its client, the port layer of `firmware`, and generated code."""
    skip_if_missing(arm_gcc, *XRCE)
    folder = build(PROCESSORS[name], FIRMWARE / "builds")
    archives = sorted(folder.glob("lib*.a"))
    names = {archive.stem for archive in archives}
    assert names >= {"libepg_runtime", "libepg_communication", "libepg_firmware", "libjiwy_xrce", "libjiwy_none_model"}
    assert names >= {"libepg_middleware_console", "libepg_middleware_xrce", "libepg_micro_xrce_dds_client"}
    programs = sorted((folder / "CMakeFiles").glob("jiwy_*_program.dir/**/*.o*"))
    assert programs
    assert [line for file in [*archives, *programs] for line in calls(file)] == []


@pytest.mark.parametrize("name", ["m33", "m7"])
def test_the_control_side_repeats_nothing(name: str) -> None:
    skip_if_missing(arm_gcc, *XRCE)
    folder = build(PROCESSORS[name], FIRMWARE / "builds")
    found = exclusives(folder / "libepg_runtime.a")
    control = {source.name for source in CONTROL.glob("*.c")}
    assert {member.removesuffix("bj").removesuffix(".o") for member in found} >= control
    assert {member: lines for member, lines in found.items() if lines} == {}


@pytest.mark.parametrize("platform", PLATFORMS)
def test_images_for_a_pico(platform: str) -> None:
    """JIWY and RELbot (C++), with a node and a console on USB: all objects of EPG and of generated code."""
    skip_unless_buildable(platform)
    skip_if_missing(*XRCE)
    folder = images("pico", platform, "jiwy_firmware", "relbot_firmware", middleware="xrce_console")
    commands = json.loads((folder / "compile_commands.json").read_text(encoding="utf-8"))
    parts = (ROOT / "targets", ROOT / "examples", folder / "epg")
    checked: set[str] = set()
    for entry in commands:
        source, words = Path(entry["file"]), shlex.split(entry["command"])
        output = words[words.index("-o") + 1]
        built = re.match(r"CMakeFiles/(epg_\w+|(jiwy|relbot)(_model|_model_export|_firmware)?)\.dir/", output)
        if built and any(source.is_relative_to(part) for part in parts):
            checked.add(source.name)
            assert calls(folder / output) == []
    assert checked >= {"stop.c", "exchange.c", "console.c", "xrce.c", "serial.c", "control_core.c", "jiwy_app.c"}
    assert checked >= {"jiwy_pico.c", "jiwy_model.c", "relbot_model_export.cpp", "flash.c", "start.c"}
