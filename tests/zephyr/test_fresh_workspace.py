"""A workspace that nobody has used before: `west init`, `west update`, `west build`."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from tests.emulator.toolchain import ROOT, arm_gcc, skip_if_missing

from .west_workspace import BOARDS, fresh_workspace, west, west_build
from .workspace import c_library, workspace

pytestmark = pytest.mark.long


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The workspace of ``examples/zephyr_jiwy``; half a gigabyte, so it does not stay."""
    skip_if_missing(partial(workspace, *BOARDS), arm_gcc, c_library)
    folder = tmp_path_factory.mktemp("fresh") / "my workspace"
    yield fresh_workspace("examples/zephyr_jiwy", folder)
    shutil.rmtree(folder)


def test_all_comes_from_the_manifest(place: Path) -> None:
    listed = west(place, "list", "-f", "{name} {abspath}").splitlines()
    assert {line.split()[0] for line in listed} >= {"manifest", "zephyr", "epg", "hal_rpi_pico", "hal_stm32"}
    assert all(line.split(" ", 1)[1].startswith(str(place)) for line in listed if "cmsis" not in line)
    assert (place / "jiwy/app/CMakeLists.txt").is_file()


@pytest.mark.parametrize("board", BOARDS)
def test_jiwy(board: str, place: Path) -> None:
    """As the README says it; EPG is the workspace's own, which west is asked for."""
    output = west_build(place, "-b", board, "-d", f"build/{board}", "jiwy/app")
    assert "warning: " not in output
    build = place / "build" / board
    assert (build / "zephyr/zephyr.elf").stat().st_size > 100_000
    ninja = (build / "build.ninja").read_text(encoding="utf-8")
    assert f"{place}/epg/targets/runtime".replace(" ", "$ ") in ninja
    assert str(ROOT) not in ninja
    assert "no work to do" in west(place, "build", "-d", f"build/{board}")


def test_west_epg(place: Path) -> None:
    assert west(place, "epg", "--cmake-dir").strip() == f"{place}/epg/cmake"
