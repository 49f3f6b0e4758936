# SPDX-License-Identifier: Apache-2.0
"""The middleware compiles with other releases of libmicroros; for this test, their headers are enough."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from integration.micro_ros.tests.conftest import build, configure

VARIABLE = "EPG_TEST_MICRO_ROS_HEADERS"
"""Variable that names folders of other libmicroros, each with include/, separated as in PATH."""
LIBRARY = "libmicroros.a"


def test_it_compiles(tmp_path: Path) -> None:
    given = os.environ.get(VARIABLE)
    if not given:
        pytest.skip(f"{VARIABLE} names no other libmicroros: its README says what it is for")
    for number, folder in enumerate(given.split(os.pathsep)):
        library = tmp_path / f"library_{number}"
        shutil.copytree(Path(folder) / "include", library / "include")
        subprocess.run(["ar", "rcs", LIBRARY], cwd=library, check=True)  # empty, because the test does not link
        build_folder = tmp_path / f"build_{number}"
        for done in (
            configure(build_folder, f"-DMICRO_ROS_PATH={library}"),
            build(build_folder, "epg_middleware_micro_ros"),
        ):
            assert done.returncode == 0, f"{folder}\n{done.stdout}{done.stderr}"
