# SPDX-License-Identifier: Apache-2.0
"""EPG offers the middleware as it offers those in its folder ``targets``.  Needs no libmicroros."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from integration.micro_ros.tests.conftest import configure
from tests.checkout import ROOT

MIDDLEWARE = ROOT / "integration/micro_ros/targets/middlewares/micro_ros"
JIWY = ROOT / "examples/jiwy"


def test_a_target_is_generated_without_a_search_for_plugins(tmp_path: Path) -> None:
    files = ["--model", str(JIWY / "model"), "--bindings", str(JIWY / "jiwy.bindings.yaml"), "--output", str(tmp_path)]
    tcf = ["--tcf", "rpi_pico_freertos_jiwy.tcf", "--set", "communication.middleware=micro_ros"]
    code = "import sys; from epg.cli.main import main; main(sys.argv[1:]); print('importlib.metadata' in sys.modules)"
    command = [sys.executable, "-c", code, "generate", "jiwy", *tcf, *files]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "False"
    cmake = (tmp_path / "jiwy.cmake").read_text(encoding="utf-8")
    folder = '"${EPG_TARGETS_DIR}/../integration/micro_ros/targets/middlewares/micro_ros'
    assert f'set(EPG_MIDDLEWARE_micro_ros_FOLDER {folder}")' in cmake
    for path in MIDDLEWARE.glob("*[!h]"):
        assert f'{folder}/{path.name}"' in cmake, "CMake's stamp knows it"
    assert "epg_micro_ros" in (tmp_path / "jiwy_app.c").read_text(encoding="utf-8")


def test_cmake_finds_its_tool_and_its_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    library = tmp_path / "library"
    monkeypatch.setenv("MICRO_ROS_PATH", str(library))
    done = configure(tmp_path / "without")
    assert done.returncode != 0
    assert "micro-ROS client library" in " ".join(done.stderr.split())
    header = library / "include/rmw_microros/rmw_microros.h"
    header.parent.mkdir(parents=True)
    header.touch()
    (library / "libmicroros.a").touch()
    done = configure(tmp_path / "with")
    assert done.returncode == 0, done.stderr
    assert "/targets/middlewares/micro_ros/micro_ros.c" in (tmp_path / "with/build.ninja").read_text(encoding="utf-8")
