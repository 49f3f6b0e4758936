# SPDX-License-Identifier: Apache-2.0
"""A new workspace works with `west init`, `west update`, `west build`."""

from __future__ import annotations

import shlex
import shutil
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, arm_gcc, skip_if_missing

from .west_workspace import BOARDS, fresh_workspace, west
from .workspace import c_library, workspace


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The workspace of ``examples/zephyr_jiwy``; deleted afterwards, because it takes half a gigabyte."""
    skip_if_missing(partial(workspace, *BOARDS), arm_gcc, c_library)
    folder = tmp_path_factory.mktemp("fresh") / "workspace"
    yield fresh_workspace("examples/zephyr_jiwy", folder)
    shutil.rmtree(folder)


def test_all_comes_from_the_manifest(place: Path) -> None:
    listed = west(place, "list", "-f", "{name} {abspath}").splitlines()
    assert {line.split()[0] for line in listed} >= {"manifest", "zephyr", "epg", "hal_rpi_pico", "hal_stm32"}
    assert all(line.split(" ", 1)[1].startswith(str(place)) for line in listed if "cmsis" not in line)
    assert (place / "jiwy/app/CMakeLists.txt").is_file()


@pytest.mark.parametrize("board", BOARDS)
def test_jiwy(board: str, place: Path) -> None:
    """The commands of the README; EPG is the one of the workspace, whose path west reports."""
    output = west(place, "build", "-b", board, "-d", f"build/{board}", "jiwy/app")
    assert "warning: " not in output
    build = place / "build" / board
    assert (build / "zephyr/zephyr.elf").stat().st_size > 100_000
    ninja = (build / "build.ninja").read_text(encoding="utf-8")
    assert f"{place}/epg/targets/runtime".replace(" ", "$ ") in ninja
    assert str(ROOT) not in ninja
    assert "no work to do" in west(place, "build", "-d", f"build/{board}")


def test_west_epg(place: Path) -> None:
    assert west(place, "epg", "--cmake-dir").strip() == f"{place}/epg/cmake"


def test_two_boards_in_one_build(place: Path) -> None:
    """sysbuild with the README's command: each image has its own target, on its own board."""
    example = place / "epg/examples/zephyr_two_boards"
    readme = (example / "README.md").read_text(encoding="utf-8")
    (command,) = (line for line in readme.splitlines() if line.startswith("west build "))
    command = command.replace("<this folder>", str(example)).replace("<epg>", str(place / "epg"))
    (place / "two").mkdir()
    output = west(place / "two", *shlex.split(command)[1:])
    assert "warning: " not in output
    images = {"zephyr_two_boards": "rpi_pico", "tilt": "nucleo_h743zi"}
    for image, board in images.items():
        folder = place / "two/build" / image / "zephyr"
        assert f'CONFIG_BOARD="{board}"' in (folder / ".config").read_text(encoding="utf-8")
        assert b"epg_control" in (folder / "zephyr.elf").read_bytes()


def test_an_existing_application(place: Path) -> None:
    """Its lamp and its decoder work beside the controller, and prj.conf has priority over EPG's defaults."""
    output = west(place, "build", "-b", "rpi_pico", "-d", "build/existing", "epg/examples/existing_zephyr_application")
    assert "warning: " not in output
    build = place / "build/existing/zephyr"
    assert "CONFIG_MAIN_STACK_SIZE=2048" in (build / ".config").read_text(encoding="utf-8").splitlines()
    tree = (build / "zephyr.dts").read_text(encoding="utf-8")
    assert "lamp = &lamp;" in tree
    assert tree.count('compatible = "epg,pico-pio-qdec"') == 1, "the controller takes the application's decoder"
    generated = (place / "build/existing/epg/turntable/turntable_zephyr.c").read_text(encoding="utf-8")
    assert "DEVICE_DT_GET(DT_NODELABEL(turntable))" in generated


def test_a_new_project(place: Path) -> None:
    """`epg new`, then `west build` with the command of its README."""
    model = str(place / "epg/examples/jiwy/model")
    west(place, "epg", "new", "--target", "rpi_pico_zephyr_jiwy", "--model", model, "robot")
    assert "\nwest build -b rpi_pico\n" in (place / "robot/README.md").read_text(encoding="utf-8")
    assert "warning: " not in west(place / "robot", "build", "-b", "rpi_pico")
    assert (place / "robot/build/zephyr/zephyr.uf2").is_file()
