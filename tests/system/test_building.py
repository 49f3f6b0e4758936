# SPDX-License-Identifier: Apache-2.0
"""Targets of a system in a CMake project."""

from __future__ import annotations

from pathlib import Path

from tests.cmake.project import Project, compiled, copy_jiwy
from tests.doubles.toolchain import skip_if_missing, tool

SYSTEM = """version: 1
system: two_jiwys
targets:
  leader: {tcf: leader, model: model, bindings: jiwy.bindings.yaml, plant: plant, plant_bindings: plant.bindings.yaml}
  follower: {tcf: follower, model: model, bindings: jiwy.bindings.yaml}
connections:
  - {from: leader/pan_publisher, to: follower/pan_subscriber}
world:
  sends: [leader/pan_subscriber, leader/tilt_subscriber, follower/tilt_subscriber]
"""
TCF = "version: 1\nextends: host_jiwy\ncommunication: {middleware: dds}\n"
LISTS = """cmake_minimum_required(VERSION 3.22)
project(robots LANGUAGES C CXX)
find_package(EPG REQUIRED)
epg_add_target(leader SYSTEM two.system.yaml)
epg_add_system(others SYSTEM two.system.yaml TARGETS follower)
"""


def project_in(folder: Path) -> Project:
    project = Project(folder, "robots")
    copy_jiwy(project.source, "model", "plant")
    for name, text in {
        "two.system.yaml": SYSTEM,
        "leader.tcf": TCF,
        "follower.tcf": TCF,
        "CMakeLists.txt": LISTS,
    }.items():
        (project.source / name).write_text(text)
    return project


def test_only_the_target_whose_files_changed_is_compiled(tmp_path: Path) -> None:
    skip_if_missing(lambda: tool("cyclonedds"))
    project = project_in(tmp_path)
    project.configure()
    project.build()
    generated = project.build_folder / "epg"
    assert '"/two_jiwys/leader/pan_publisher"' in (generated / "follower" / "follower_app.c").read_text()
    assert "_plant" in (generated / "leader" / "leader_host.c").read_text()
    assert not compiled(project.build())
    project.edit("leader.tcf", "communication: {", "communication: {period: 20 ms, ")
    names = compiled(project.build())
    assert names and all("leader" in name for name in names)
    project.edit("two.system.yaml", "system: two_jiwys", "system: jiwys")
    names = compiled(project.build())
    assert {"leader_app.c", "follower_app.c"} <= names


def test_mistakes_are_reported_with_their_place(tmp_path: Path) -> None:
    project = project_in(tmp_path)
    project.edit("CMakeLists.txt", "target(leader SYSTEM", "target(leder SYSTEM")
    output = project.fails_to_configure()
    assert "CMakeLists.txt:4:16: error: the system 'two_jiwys' has no target 'leder'" in output
    assert "did you mean 'leader'?" in output
    project.edit("CMakeLists.txt", "TARGETS follower", "TARGETS folower")
    output = project.fails_to_configure()
    assert "CMakeLists.txt:5:54: error: the system 'two_jiwys' has no target 'folower'" in output
    project.edit("CMakeLists.txt", "target(leder SYSTEM", "target(leader TCF a.tcf SYSTEM")
    assert "the file of the system says this: remove TCF" in project.fails_to_configure()
    project.edit("CMakeLists.txt", "TCF a.tcf SYSTEM two.system", "SYSTEM three.system")
    assert "three.system.yaml" in project.fails_to_configure()


def test_a_project_for_a_microcontroller_simulates_nothing(tmp_path: Path) -> None:
    project = project_in(tmp_path)
    project.edit("CMakeLists.txt", "epg_add_target", "#")
    project.edit("CMakeLists.txt", " TARGETS follower", "")
    output = " ".join(project.fails_to_configure("-DCMAKE_SYSTEM_NAME=Generic").split())
    assert "epg_add_system(others): systems are simulated on a computer, and this project is for Generic." in output
    assert "name its targets: epg_add_system(others SYSTEM two.system.yaml TARGETS <target>...)" in output
