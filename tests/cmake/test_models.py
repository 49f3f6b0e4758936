# SPDX-License-Identifier: Apache-2.0
"""epg_add_model: models as libraries, several in one image."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from tests.cmake.project import ROOT, Project


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Project:
    project = Project(tmp_path_factory.mktemp("models"), "models")
    project.configure(f"-DEXAMPLES={ROOT / 'examples'}")
    project.build()
    return project


def test_models_side_by_side(built: Project) -> None:
    done = subprocess.run([built.build_folder / "together"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    first, instances, again, parameters, by_hand = done.stdout.splitlines()
    values = dict(zip(first.split()[::2], map(float, first.split()[1::2])))
    assert values["first"] == 0, "its homing has reached its time limit"
    assert values["second"] == -0.05, "its twin, which was not stepped, is still homing"
    assert instances == "instances 1 frozen 0 third 0"
    assert again == "again 1 finite 1 stopped 0"
    assert parameters == "parameters 2.6 5 2.6"
    assert by_hand == "by hand 2 step 0.001 0.002"


def test_the_headers_are_cpp_too(built: Project) -> None:
    done = subprocess.run([built.build_folder / "together_cpp"], capture_output=True, text=True, check=True)
    assert done.stdout == "2 1\n"


def test_a_cpp_model_needs_cpp(tmp_path: Path) -> None:
    project = Project(tmp_path, "models")
    project.edit("CMakeLists.txt", "LANGUAGES C CXX", "LANGUAGES C")
    output = " ".join(project.fails_to_configure(f"-DEXAMPLES={ROOT / 'examples'}").split())
    assert "model 'wheels' needs CXX: write project(models LANGUAGES C CXX)" in output


def test_instances_of_a_model_with_globals_are_refused(tmp_path: Path) -> None:
    project = Project(tmp_path, "models")
    project.edit(
        "CMakeLists.txt",
        "epg_add_model(first MODEL ${EXAMPLES}/jiwy/model)",
        "epg_add_model(first MODEL ${EXAMPLES}/jiwy/model INSTANCES 2)",
    )
    output = project.fails_to_configure(f"-DEXAMPLES={ROOT / 'examples'}")
    assert "[single-instance]" in output
    assert "model 'first' was not generated" in output


def test_a_changed_export_is_compiled_again(tmp_path: Path) -> None:
    from tests.cmake.project import compiled

    project = Project(tmp_path, "robot")
    project.configure()
    project.build()
    project.edit("model/controller.c", "outputs->reset = 0.0", "outputs->reset = 0.5")
    output = project.build()
    assert "controller.c" in compiled(output)
    assert "robot_app.c" not in compiled(output)
