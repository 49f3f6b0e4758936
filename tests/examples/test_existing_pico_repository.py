# SPDX-License-Identifier: Apache-2.0
"""``examples/existing_pico_repository``: one executable gets a controller, and the other executables do not change."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

from tests.doubles.toolchain import pico_sdk
from tests.examples.pico_project import ROOT, commands, configure, digests, picotool, run, skip_unless_buildable

EXAMPLE = ROOT / "examples/existing_pico_repository"
BLOCK = re.compile(r"\n# --- the turntable's controller, by EPG ---\n(.*\n.*\n.*\n)# ---\n")
BUILT = ("blink", "hello_usb")
"""The other executables that tests build; of all others, the commands are compared."""


def options(board: str) -> list[str]:
    return [f"-DPICO_SDK_PATH={pico_sdk()}", f"-DPICO_BOARD={board}", f"-Dpicotool_DIR={picotool()}"]


def test_the_readme_shows_the_three_lines() -> None:
    added = BLOCK.search((EXAMPLE / "turntable/CMakeLists.txt").read_text(encoding="utf-8"))
    assert added
    lines = added[1].splitlines()
    assert len(lines) == 3
    readme = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    assert "".join(f"+{line}\n" for line in lines) in readme


def test_the_import_file_is_epgs() -> None:
    assert (EXAMPLE / "epg_import.cmake").read_bytes() == (ROOT / "cmake/epg_import.cmake").read_bytes()


def test_other_executables_do_not_notice(tmp_path: Path) -> None:
    """The lines are added to a built repository: no file of the other executables is compiled or linked again."""
    skip_unless_buildable()
    repository = shutil.copytree(EXAMPLE, tmp_path / "repository")
    build = repository / "build"
    file = repository / "turntable/CMakeLists.txt"
    with_epg = file.read_text(encoding="utf-8")
    file.write_text(BLOCK.sub("\n", with_epg), encoding="utf-8")
    configure(repository, *options("pico"))
    run(repository, "cmake", "--build", "build", "--target", *BUILT)
    before, files = commands(build), digests(build, *BUILT)
    assert {f"{name}/{name}.uf2" for name in BUILT} <= set(files)

    file.write_text(with_epg, encoding="utf-8")
    output = run(repository, "cmake", "--build", "build", "--target", *BUILT)
    assert "Generating done" in output
    assert digests(build, *BUILT) == files
    after = commands(build)
    others = {key: entry for key, entry in before.items() if "CMakeFiles/turntable_station.dir" not in key}
    assert {key.split("/")[0] for key in others} >= {"blink", "hello_usb", "thermometer"}
    assert {key: after[key] for key in others} == others

    assert changes(before, after) == NEEDED
    main = repository / "turntable/main.c"
    with_start = main.read_text(encoding="utf-8")
    main.write_text("int main(void)\n{\n    return 0;\n}\n", encoding="utf-8")
    # it links, although it does not call EPG yet
    run(repository, "cmake", "--build", "build", "--target", "turntable_station")
    main.write_text(with_start, encoding="utf-8")
    output = run(repository, "cmake", "--build", "build", "--target", "turntable_station")
    assert_good(build, output)
    assert digests(build, *BUILT) == files


NEEDED = {
    # TinyUSB and the libraries of the SDK that EPG links
    "CFG_TUSB_DEBUG", "CFG_TUSB_MCU", "CFG_TUSB_OS", "PICO_RP2040_USB_DEVICE_UFRAME_FIX",
    "LIB_PICO_FIX_RP2040_USB_DEVICE_ENUMERATION", "LIB_PICO_MULTICORE", "LIB_PICO_UNIQUE_ID",
    # Definitions that EPG sets for the SDK's C files
    "PICO_CORE1_STACK_SIZE", "PICO_DOUBLE_PROPAGATE_NANS", "PICO_USE_STACK_GUARDS",
    # <name>.h, epg/control.h, epg/pico.h, epg/pico_quadrature.h, tusb_config.h, tusb.h
    "build/epg/turntable", "targets/runtime/include", "targets/families/rp2/include",
    "targets/mcu/include",
    "targets/libraries/pico_quadrature/include", "targets/families/rp2/usb/include", "lib/tinyusb/src",
}  # fmt: skip
"""Definitions and include folders that EPG adds to the commands for the program's own files."""


def changes(before: dict[str, dict[str, str]], after: dict[str, dict[str, str]]) -> set[str]:
    """The differences for main.c of the executable that gets the controller, except for the SDK's system headers."""
    words = [set(shlex.split(commands["turntable/CMakeFiles/turntable_station.dir/main.c.o"]["command"]))
             for commands in (before, after)]  # fmt: skip
    found = {word.split("=")[0].removeprefix("-D") for word in words[0] ^ words[1] if word.startswith("-D")}
    folders = {word for word in words[0] ^ words[1] if word.startswith("-I")}
    return found | {next((name for name in NEEDED if folder.endswith(name)), folder) for folder in folders}


def assert_good(build: Path, output: str) -> None:
    """The controller's executable exists, with no warning except the SDK's own."""
    warned = re.findall(r"^(\S+?):\d+:\d+: warning: ", output, re.MULTILINE)
    assert [file for file in warned if not file.startswith(str(pico_sdk()))] == []
    folder = build / "turntable"
    info = run(folder, picotool() / "picotool", "info", "-a", "turntable_station.uf2")
    assert re.search(r"EPG \S+ target turntable ", info)


def test_the_controllers_executable_for_pico_2(tmp_path: Path) -> None:
    skip_unless_buildable()
    repository = shutil.copytree(EXAMPLE, tmp_path / "repository")
    configure(repository, *options("pico2"))
    assert_good(repository / "build", run(repository, "cmake", "--build", "build", "--target", "turntable_station"))


def test_another_board_is_one_clear_message(tmp_path: Path) -> None:
    """The board that CMake builds for differs from the target's board."""
    skip_unless_buildable()
    repository = shutil.copytree(EXAMPLE, tmp_path / "repository")
    file = repository / "turntable/CMakeLists.txt"
    file.write_text(file.read_text().replace("rpi_${PICO_BOARD}_bare_metal", "rpi_pico_bare_metal"))
    output = configure(repository, *options("pico2"), check=False)
    assert "its target is for the board 'pico', and PICO_BOARD is" in " ".join(output.split())


def test_stdio_over_usb_in_the_same_executable_is_one_clear_message(tmp_path: Path) -> None:
    skip_unless_buildable()
    repository = shutil.copytree(EXAMPLE, tmp_path / "repository")
    file = repository / "turntable/CMakeLists.txt"
    file.write_text(file.read_text() + "pico_enable_stdio_usb(turntable_station 1)\n")
    output = " ".join(configure(repository, *options("pico"), check=False).split())
    assert "turntable_station" in output and "stdio" in output
