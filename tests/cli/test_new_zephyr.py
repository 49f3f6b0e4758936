# SPDX-License-Identifier: Apache-2.0
"""``epg new`` for Zephyr: an application and a workspace, without files of other build systems."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from epg.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
JIWY = ROOT / "examples/jiwy/model"
TARGETS = {
    "rpi_pico_zephyr_jiwy": ("rpi_pico", ["hal_rpi_pico"]),
    "rpi_pico2_zephyr": ("rpi_pico2/rp2350a/m33", ["hal_rpi_pico"]),
    "nucleo_h743zi_zephyr_jiwy": ("nucleo_h743zi", ["hal_stm32"]),
    "native_sim_jiwy": ("native_sim", []),
}


def new(folder: Path, target: str) -> Path:
    assert main(["new", str(folder), "--target", target, "--model", str(JIWY), "--name", "robot"]) == 0
    return folder


@pytest.mark.parametrize("target", TARGETS)
def test_a_project_is_complete_and_right(target: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    project = new(tmp_path / "my robot", target)
    assert "to bind" not in capsys.readouterr().out
    files = [f"--{kind}={project / name}" for kind, name in (("tcf", "robot.tcf"), ("model", "model"))]
    assert main(["check", *files, f"--bindings={project / 'robot.bindings.yaml'}"]) == 0
    assert main(["check", str(project / "simulation/robot_host.tcf")]) == 0
    assert "enable_at_start: false" in (project / "robot.tcf").read_text()
    names = {path.relative_to(project).as_posix() for path in project.rglob("*") if path.is_file()}
    assert {"CMakeLists.txt", "prj.conf", "src/main.c", "west.yml", "epg_import.cmake", ".gitignore"} <= names
    assert not [name for name in names if "sdk" in name or "Presets" in name]


@pytest.mark.parametrize("target", TARGETS)
def test_the_target_is_there_before_zephyr(target: str, tmp_path: Path) -> None:
    """find_package(Zephyr) reads the devicetree: anything defined after it is too late."""
    text = (new(tmp_path / "robot", target) / "CMakeLists.txt").read_text()
    words = ("\ninclude(epg_import.cmake)", "\nepg_add_target(robot", "\nfind_package(Zephyr")
    places = [text.index(word) for word in words]
    assert places == sorted(places)


@pytest.mark.parametrize(("target", "expected"), TARGETS.items())
def test_board_and_modules(target: str, expected: tuple[str, list[str]], tmp_path: Path) -> None:
    """The README builds for the target's board, and the manifest has the modules that this board needs."""
    board, hals = expected
    project = new(tmp_path / "robot", target)
    assert f"\nwest build -b {board}\n" in (project / "README.md").read_text()
    manifest = yaml.safe_load((project / "west.yml").read_text())["manifest"]
    (zephyr,) = manifest["projects"]
    assert zephyr["revision"] == "v4.1.0"
    assert zephyr["import"]["name-allowlist"] == ["cmsis", "cmsis_6", *hals]
