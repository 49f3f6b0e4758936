# SPDX-License-Identifier: Apache-2.0
"""``examples/existing_firmware``: a repository with its own conventions gets a controller; all else stays the same."""

from __future__ import annotations

import json
import os
import re
import shutil
import struct
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
EXAMPLE = ROOT / "examples" / "existing_firmware"
BLOCK = re.compile(r"\n# --- the turntable's controller, by EPG ---\n(.*\n.*\n.*\n)# ---\n")


def run(folder: Path, *command: str, check: bool = True) -> str:
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("EPG_DIR", "EPG_PATH", "CMAKE_"))}
    done = subprocess.run(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert not check or done.returncode == 0, done.stdout
    return done.stdout


def copy(folder: Path) -> Path:
    """The example as a separate repository."""
    return shutil.copytree(EXAMPLE, folder / "repository", ignore=shutil.ignore_patterns("build"))


def configure(repository: Path, preset: str = "host") -> str:
    return run(repository, "cmake", "--preset", preset, f"-DEPG_PATH={ROOT}", f"-DPython3_EXECUTABLE={sys.executable}")


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    repository = copy(tmp_path_factory.mktemp("existing_firmware"))
    configure(repository)
    run(repository, "cmake", "--build", "--preset", "host")
    return repository


def test_the_readmes_commands(built: Path) -> None:
    readme = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    commands = re.findall(r"^(?:cmake|build/).*$", readme, re.MULTILINE)
    assert commands[0] == "cmake --preset host && cmake --build --preset host && ctest --preset host"
    run(built, "ctest", "--preset", "host")
    reports = run(built, "sh", "-c", commands[1]).splitlines()
    assert len(reports) == 10
    cycles = [int(re.fullmatch(r"enabled after (\d+) cycles, \d+ overruns", report)[1]) for report in reports]  # type: ignore[index]
    assert cycles == sorted(set(cycles))
    assert cycles[-1] <= 2500
    reports = run(built, "sh", "-c", commands[1].replace(" --enable", "")).splitlines()
    assert all(report.startswith("disabled after ") for report in reports), "the station starts disabled"


def test_the_readme_shows_the_lines_that_were_added() -> None:
    added = BLOCK.search((EXAMPLE / "station/CMakeLists.txt").read_text(encoding="utf-8"))
    assert added
    readme = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    assert "".join(f"+{line}\n" for line in added[1].splitlines()) in readme


def test_the_import_file_is_epgs() -> None:
    assert (EXAMPLE / "cmake/epg_import.cmake").read_bytes() == (ROOT / "cmake/epg_import.cmake").read_bytes()


def commands(repository: Path) -> dict[str, dict[str, str]]:
    entries = json.loads((repository / "build/host/compile_commands.json").read_text())
    return {entry["file"]: entry for entry in entries}


def test_other_executables_are_compiled_as_before(built: Path, tmp_path: Path) -> None:
    with_epg = commands(built)
    # in the same folder, so that the commands can be compared byte by byte
    aside = built.with_name("with_epg")
    built.rename(aside)
    try:
        without = copy(built.parent)
        file = without / "station/CMakeLists.txt"
        file.write_text(BLOCK.sub("\n", file.read_text(encoding="utf-8")), encoding="utf-8")
        assert "epg" not in file.read_text(encoding="utf-8").lower()
        configure(without)
        before = commands(without)
        shutil.rmtree(without)
    finally:
        aside.rename(built)
    station = str(built / "station/main.c")
    assert station in before
    assert len(before) == 4
    del before[station]
    assert {file: with_epg[file] for file in before} == before


def test_warnings_of_the_repository_hold_for_generated_code(built: Path) -> None:
    for file, entry in commands(built).items():
        exported = "/station/model/" in file or file.endswith("_export.c")
        assert "-Wall -Wextra -Wconversion -Werror" in entry["command"]
        assert (" -w " in entry["command"]) == exported, file
    assert any(file.endswith("epg/turntable/turntable_app.c") for file in commands(built))


def test_careless_exported_code_fails_no_build(tmp_path: Path) -> None:
    repository = copy(tmp_path)
    file = repository / "station/model/xxfuncs.c"
    careless = (
        "\nint careless (double x, int unused)\n{\n\tint narrow = x;\n\tfloat never = 1.5;\n\treturn narrow;\n}\n"
    )
    file.write_text(file.read_text(encoding="utf-8") + careless, encoding="utf-8")
    done = run(tmp_path, "cc", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-c", str(file), "-o", "x.o", check=False)
    assert "-Werror" in done
    configure(repository)
    run(repository, "cmake", "--build", "--preset", "host", "--target", "turntable")


@pytest.fixture(scope="module")
def board(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The example, built for the board: its CMakeLists.txt makes warnings errors, also in EPG's code."""
    if shutil.which("arm-none-eabi-gcc") is None:
        pytest.skip("arm-none-eabi-gcc is not installed: sudo apt install gcc-arm-none-eabi libnewlib-arm-none-eabi")
    repository = copy(tmp_path_factory.mktemp("board"))
    configure(repository, "nucleo_h743zi")
    run(repository, "cmake", "--build", "--preset", "nucleo_h743zi")
    return repository / "build/nucleo_h743zi"


@pytest.mark.parametrize("name", ["selftest/selftest.elf", "station/nucleo_h743zi/station.elf"])
def test_the_board(board: Path, name: str) -> None:
    text = run(board, "arm-none-eabi-readelf", "-hA", name)
    assert "Tag_CPU_arch: v7E-M" in text
    assert "Tag_ABI_VFP_args: VFP registers" in text
    symbols = run(board, "arm-none-eabi-nm", name)
    assert re.search(r"^08000000 . board_vectors$", symbols, re.MULTILINE)


def test_the_station_on_the_board(board: Path) -> None:
    """The vectors lead to the control cycle and to the safe state; there is no heap, and nothing of stdio."""
    station = "station/nucleo_h743zi/station.elf"
    symbols = run(board, "arm-none-eabi-nm", station)
    names = {line.split()[-1] for line in symbols.splitlines()}
    assert names >= {"turntable_cycle", "turntable_safe", "turntable_model_step"}
    assert not names & {"malloc", "_malloc_r", "_sbrk", "printf", "_write", "fopen"}
    addresses = {line.split()[-1]: int(line.split()[0], 16) for line in symbols.splitlines() if len(line.split()) == 3}
    run(board, "arm-none-eabi-objcopy", "-O", "binary", "-j", ".text", station, "station.bin")
    vectors = struct.unpack("<71I", (board / "station.bin").read_bytes()[: 71 * 4])
    for number, handler in {
        1: "board_reset",
        3: "HardFault_Handler",
        55: "USART3_IRQHandler",
        70: "TIM6_DAC_IRQHandler",
    }.items():
        assert vectors[number] == addresses[handler] | 1, handler


def test_the_board_s_pins_have_the_timers_of_the_drivers() -> None:
    """EPG's data of the chip know the same alternate functions."""
    soc = (ROOT / "targets/socs/stm32h743/soc.yaml").read_text(encoding="utf-8")
    drivers = (EXAMPLE / "boards/nucleo_h743zi/Core/Src/tim.c").read_text(encoding="utf-8")
    for pin, function in re.findall(r"pin_function\(GPIO(\w, \d+), (\d+)\)", drivers):
        assert re.search(rf"\bP{pin.replace(', ', '')}: {function}\b", soc), pin


def test_the_board_s_controller_is_added_by_the_same_lines() -> None:
    added = BLOCK.search((EXAMPLE / "station/nucleo_h743zi/CMakeLists.txt").read_text(encoding="utf-8"))
    assert added
    assert len(added[1].splitlines()) == 3
    readme = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    drivers = (EXAMPLE / "station/nucleo_h743zi/turntable_drivers.c").read_text(encoding="utf-8")
    functions = re.findall(r"^\w+ turntable_\w+\(", drivers, re.MULTILINE)
    assert f"| `turntable_drivers.c` | {len(functions)} functions" in readme
