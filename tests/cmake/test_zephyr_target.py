# SPDX-License-Identifier: Apache-2.0
"""epg_add_target() before find_package(Zephyr): the variables that Zephyr gets, for every way in which users set them.

A replacement of Zephyr's package has the same rules for variables; tests/zephyr builds with the real one.
"""

from __future__ import annotations

import itertools
import re
import shutil
import sys
from pathlib import Path

import pytest

from tests.cmake.project import ROOT, Project, snapshot

CONFIG = "EPG=y;GPIO=y;PWM=y;SENSOR=y;NUM_METAIRQ_PRIORITIES=1"
FINE = (f"-DCONFIG={CONFIG}", "-DNODES=epg_robot;pwm", "-DFAKE_/pwm_divider-int-1=1")
"""Zephyr's default result for EPG's shield."""


@pytest.fixture
def project(tmp_path: Path) -> Project:
    project = Project(tmp_path, "zephyr")
    project.environment["ZEPHYR_BASE"] = str(project.source / "base")
    return project


def seen(output: str, what: str) -> str:
    """The value that the replacement of Zephyr's package has got."""
    (found,) = re.findall(rf"^-- {what}: ?(.*)$", output, re.MULTILINE)
    return str(found)


def joined(output: str) -> str:
    """CMake's output without its line breaks."""
    return " ".join(output.split())


def test_board_shield_and_module_are_given_to_zephyr(project: Project) -> None:
    output = project.configure(*FINE)
    assert seen(output, "Board") == "rpi_pico"
    assert seen(output, "Shields") == "epg_robot"
    assert seen(output, "Modules") == str(ROOT)
    names = ("Kconfig.defconfig", "Kconfig.shield", "epg_robot.overlay")
    assert seen(output, "Files of shields") == ";".join(f"boards/shields/epg_robot/{name}" for name in names)
    assert "CMake Warning" not in output


def test_a_second_run_changes_nothing_and_starts_no_python(project: Project, tmp_path: Path) -> None:
    """Zephyr's own scripts are Python; the interpreter for EPG is one that records every start."""
    python = tmp_path / "python"
    log = tmp_path / "starts"
    python.write_text(f'#!/bin/sh\necho start >> "{log}"\nexec "{sys.executable}" "$@"\n')
    python.chmod(0o755)
    project.configure(*FINE, f"-DPython3_EXECUTABLE={python}")
    assert "start" in log.read_text()
    log.unlink()
    shield = project.build_folder / "CMakeFiles/epg/robot"
    times = {path: path.stat().st_mtime_ns for path in shield.rglob("*.*")}
    before = snapshot(shield)
    output = project.configure(*FINE, f"-DPython3_EXECUTABLE={python}")
    assert not log.exists()
    assert seen(output, "Shields") == "epg_robot"
    assert seen(output, "Modules") == str(ROOT)
    assert "CMake Warning" not in output
    assert snapshot(shield) == before
    assert {path: path.stat().st_mtime_ns for path in shield.rglob("*.*")} == times


def test_a_users_shields_stay(project: Project) -> None:
    for _ in range(3):  # west passes the same arguments again
        output = project.configure(*FINE, "-DSHIELD=one two")
        assert seen(output, "Shields") == "one two epg_robot"
        assert "CMake Warning" not in output
    output = project.configure(*FINE)
    assert seen(output, "Shields") == "one two epg_robot"


@pytest.mark.parametrize("way", ["environment", "project"])
def test_shields_from_elsewhere_stay(project: Project, way: str) -> None:
    if way == "environment":
        project.environment["SHIELD"] = "mine"
    else:
        (project.source / "before.cmake").write_text("set(SHIELD mine)\n")
    for _ in range(2):
        output = project.configure(*FINE)
        assert seen(output, "Shields") == "mine epg_robot"
        assert "CMake Warning" not in output


def test_another_shield_later_is_what_zephyr_warns_about(project: Project) -> None:
    project.configure(*FINE, "-DSHIELD=one")
    output = project.configure(*FINE, "-DSHIELD=two")
    assert "must be cleaned pristinely" in output
    assert seen(output, "Shields") == "one epg_robot"


def test_an_application_that_was_built_before_gains_the_target(project: Project) -> None:
    text = (project.source / "CMakeLists.txt").read_text()
    without = re.sub(r"(?m)^  epg_add_target\(.*\n", "", text)
    (project.source / "CMakeLists.txt").write_text(without)
    assert seen(project.configure("-DBOARD=rpi_pico"), "Shields") == ""
    (project.source / "CMakeLists.txt").write_text(text)
    output = project.configure(*FINE)
    assert seen(output, "Shields") == "epg_robot"
    assert "CMake Warning" not in output


@pytest.mark.parametrize(
    ("way", "variable"),
    [
        *itertools.product(
            ("command line", "environment", "project"), ("EXTRA_ZEPHYR_MODULES", "ZEPHYR_EXTRA_MODULES")
        ),
        ("project afterwards", "EXTRA_ZEPHYR_MODULES"),  # Zephyr reads one of the two, which EPG has set by then
    ],
)
def test_a_users_modules_stay(project: Project, variable: str, way: str, tmp_path: Path) -> None:
    other = tmp_path / "other"
    arguments = [f"-D{variable}={other}"] if way == "command line" else []
    if way == "environment":
        project.environment[variable] = str(other)
    if way.startswith("project"):
        name = "between.cmake" if way.endswith("afterwards") else "before.cmake"
        (project.source / name).write_text(f'list(APPEND {variable} "{other}")\n')
    for _ in range(2):
        assert sorted(seen(project.configure(*FINE, *arguments), "Modules").split(";")) == sorted(
            [str(ROOT), str(other)]
        )


def test_a_module_that_is_there_is_not_added(project: Project) -> None:
    output = project.configure(*FINE, f"-DEXTRA_ZEPHYR_MODULES={ROOT}")
    assert seen(output, "Modules") == str(ROOT)


@pytest.mark.parametrize("board", ["rpi_pico", "rpi_pico/rp2040", "rpi_pico@1/rp2040/w"])
def test_the_boards_that_a_target_is_for(project: Project, board: str) -> None:
    assert seen(project.configure(*FINE, f"-DBOARD={board}"), "Board") == board


@pytest.mark.parametrize("way", ["command line", "environment", "project"])
def test_another_board_is_refused(project: Project, way: str) -> None:
    arguments = ["-DBOARD=rpi_pico2/rp2350a/m33"] if way == "command line" else []
    if way == "environment":
        project.environment["BOARD"] = "rpi_pico2/rp2350a/m33"
    if way == "project":
        (project.source / "before.cmake").write_text("set(BOARD rpi_pico2/rp2350a/m33)\n")
    output = project.fails_to_configure(*FINE, *arguments)
    assert "its target is for Zephyr's board 'rpi_pico', and BOARD is 'rpi_pico2/rp2350a/m33'" in joined(output)
    assert "Board:" not in output


def test_a_second_target_is_refused(project: Project) -> None:
    (project.source / "between.cmake").write_text(
        "epg_add_target(other TCF robot.tcf MODEL ../robot/model BINDINGS ../robot/bindings.yaml)\n"
    )
    output = joined(project.fails_to_configure(*FINE))
    assert "epg_add_target(other): this image has the target 'robot' already, and an image of Zephyr runs one" in output
    assert "sysbuild" in output


def test_a_target_after_zephyr_is_refused(project: Project) -> None:
    output = project.fails_to_configure(*FINE, "-DLATE=ON", "-DBOARD=rpi_pico")
    assert "epg_add_target(robot): Zephyr has read its devicetree already" in output


def test_a_project_without_zephyr_is_told_what_to_write(project: Project) -> None:
    output = project.fails_to_configure(*FINE, "-DPLAIN=ON")
    assert "this project is none of Zephyr's" in joined(output)
    assert "find_package(Zephyr REQUIRED HINTS $ENV{ZEPHYR_BASE})" in output


def test_zephyr_that_does_not_read_the_module_is_reported(project: Project) -> None:
    (project.source / "between.cmake").write_text("unset(EXTRA_ZEPHYR_MODULES)\n")
    output = project.fails_to_configure(*FINE)
    assert "Zephyr did not read EPG as a module" in joined(output)
    assert f"-DEXTRA_ZEPHYR_MODULES={ROOT}" in output


def test_the_executable_is_app(project: Project) -> None:
    (project.source / "after.cmake").write_text("epg_add_executable(robot_firmware EPG::robot)\n")
    assert "epg_add_executable(app EPG::robot)" in joined(project.fails_to_configure(*FINE))
    (project.source / "after.cmake").write_text("epg_add_executable(app EPG::robot)\n")
    project.configure(*FINE)
    assert "robot_start()" in (project.build_folder / "epg/robot_main.c").read_text()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-DCONFIG=" + CONFIG.replace("PWM=y", "PWM=n")], "CONFIG_PWM is n, and the target needs y"),
        (
            ["-DCONFIG=" + CONFIG.replace("IES=1", "IES=0")],
            "CONFIG_NUM_METAIRQ_PRIORITIES is 0, and the control thread needs at least 1",
        ),
        (["-DNODES=pwm"], "the devicetree has no node epg_robot that is enabled"),
        (["-DFAKE_/pwm_divider-int-1=9"], "&pwm has divider-int-1 = <9>, and components.motor needs <1>"),
    ],
)
def test_differences_from_what_the_target_needs_are_errors(
    project: Project, arguments: list[str], message: str
) -> None:
    output = project.fails_to_configure(*FINE, *arguments)
    assert message in joined(output)
    assert f"{project.build_folder}/epg/robot/robot.overlay" in joined(output)


def test_more_of_what_is_needed_is_no_difference(project: Project) -> None:
    project.configure(*FINE, "-DCONFIG=" + CONFIG.replace("IES=1", "IES=2"))


def test_every_difference_is_reported_at_once(project: Project) -> None:
    output = project.fails_to_configure(*FINE, "-DCONFIG=EPG=y", "-DNODES=pwm", "-DFAKE_/pwm_divider-int-1=9")
    assert len(re.findall(r"^ +(?:CONFIG_\w+ is|the devicetree)", output, re.MULTILINE)) == 6


@pytest.mark.parametrize(
    ("given", "built_by", "above"),
    [
        ((), "cmake", ""),
        (("WEST_PYTHON",), "west", ".."),
    ],
)
def test_the_target_that_connects_says_how_zephyr_is_built(
    project: Project, given: tuple[str, ...], built_by: str, above: str
) -> None:
    """By west if west configures; an image of sysbuild is built in the folder around its own.

    The targets ``robot_connect`` and ``robot_live`` say the same.
    """
    project.configure(*FINE, *(f"-D{name}={sys.executable}" for name in given), *(["-DSYSBUILD=ON"] if above else []))
    rules = (project.build_folder / "build.ninja").read_text()
    said = re.findall(r"__main__\.py connect --name robot .*--build-dir (\S+) --built-by (\w+)(.*)", rules)
    expected = (str((project.build_folder / above).resolve()), built_by)
    assert [(folder, program, "--live" in rest) for folder, program, rest in said] == [
        (*expected, False),
        (*expected, True),
    ]


def test_the_image_of_a_target_of_a_system(project: Project) -> None:
    """EPG's own project, which `<name>_images` of epg_add_system() builds."""
    (project.source / "cell.system.yaml").write_text(
        "version: 1\nsystem: cell\n"
        "targets: {robot: {tcf: robot, model: ../robot/model, bindings: ../robot/bindings.yaml}}\n"
        "world: {sends: [robot/target]}\n"
    )
    image = ROOT / "targets/platforms/zephyr/image"
    (project.source / "CMakeLists.txt").write_text((image / "CMakeLists.txt").read_text())
    given = (f"-DEPG_IMAGE_SYSTEM={project.source}/cell.system.yaml", "-DEPG_IMAGE=robot", "-DEPG_IMAGE_BOARD=rpi_pico")
    output = project.configure(*FINE, *given)
    assert seen(output, "Board") == "rpi_pico"
    assert seen(output, "Shields") == "epg_robot"
    assert "robot_start()" in (project.build_folder / "epg/robot_main.c").read_text()
    assert (image / "prj.conf").is_file(), "Zephyr needs this file"

    project.edit("CMakeLists.txt", "epg_add_target(${EPG_IMAGE} ", "epg_add_system(some TARGETS robot ")
    output = project.configure(*FINE, *given)
    assert seen(output, "Board") == "rpi_pico"
    assert seen(output, "Modules") == str(ROOT)
    shutil.rmtree(project.build_folder)
    output = project.fails_to_configure(*FINE, *given[:2], "-DEPG_IMAGE_BOARD=nucleo_h743zi")
    assert "epg_add_target(robot): its target is for Zephyr's board 'rpi_pico', and BOARD is" in joined(output)
    project.environment["ZEPHYR_BASE"] = str(project.source / "no Zephyr")
    assert "The environment variable ZEPHYR_BASE does not lead to the Zephyr" in project.fails_to_configure(
        *FINE, *given
    )
