# SPDX-License-Identifier: Apache-2.0
"""Builds that `epg connect` runs for boards: the products that they list, and the start of west."""

from __future__ import annotations

import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from epg.connect.build.plan import make_plan
from epg.connect.projects import Job
from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.configuration import Configuration
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import load_configuration
from tests.connect.builds import job_of, run
from tests.connect.robots import new_project
from tests.doubles.toolchain import arm_gcc, pico_sdk, skip_if_missing
from tests.zephyr.workspace import NATIVE, Missing, workspace


@pytest.fixture
def pico(new_project: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(new_project, tmp_path / "pico robot"))


def test_a_raspberry_pi_pico_gets_its_uf2(pico: Path) -> None:
    skip_if_missing(arm_gcc, pico_sdk)
    state = run(job_of(pico)).state()
    assert state["state"] == "done" and state["messages"] == [], state["messages"]
    assert [product["path"] for product in state["products"]] == [
        str(pico / "build/robot_firmware.uf2"),
        str(pico / "build/robot_firmware.elf"),
    ]
    assert "BOOTSEL" in state["products"][0]["what"]
    data = (pico / "build/robot_firmware.uf2").read_bytes()
    assert data[:4] == b"UF2\n" and len(data) % 512 == 0


def test_a_program_of_zephyr_by_west(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    skip_if_missing(workspace, west)
    here = workspace()
    for name, value in here.environment().items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("ZEPHYR_TOOLCHAIN_VARIANT", "host")
    new_project(tmp_path / "robot", "native_sim_jiwy")
    job = replace(job_of(tmp_path / "robot"), board=NATIVE)
    assert job.built_by == "west"
    plan = make_plan(replace(job, board=""), load(job))
    assert plan.steps[0].command[1:] == (
        *("build", "--cmake-only", "-d", str(tmp_path / "robot/build"), "-b", "native_sim"),
        str(tmp_path / "robot"),
    ), "the board as Zephyr calls it"
    build = run(job)
    state = build.state()
    assert state["state"] == "done", state["messages"]
    (product,) = state["products"]
    assert product["path"] == str(tmp_path / "robot/build/zephyr/zephyr.exe")
    done = subprocess.run([product["path"], "-duration=0.1"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr

    with (tmp_path / "robot/prj.conf").open("a") as file:
        file.write("CONFIG_NONSENSE_OF_MINE=y\n")
    errors = [found for found in run(job).state()["messages"] if found["severity"] == "error"]
    assert [(found["file"], "NONSENSE_OF_MINE" in found["message"]) for found in errors] == [
        (str(tmp_path / "robot/prj.conf"), True)
    ]


def load(job: Job) -> Configuration:
    configuration = load_configuration(job.request, load_catalog(job.request.roots, Diagnostics()), Diagnostics())
    assert configuration is not None
    return configuration


def west() -> None:
    """Raises Missing if Zephyr's Python does not have west."""
    if not (workspace().python.parent / "west").exists():
        raise Missing(f"west is not installed: {workspace().python} -m pip install west")
