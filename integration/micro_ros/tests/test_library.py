# SPDX-License-Identifier: Apache-2.0
"""A libmicroros that does not fit or is missing is reported before a target runs."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

import pytest

from integration.micro_ros.tests.conftest import build, configure


def changed_library(folder: Path, name: str, value: str) -> Path:
    """A copy of the user's libmicroros with another value of ``name``, as if it had been built so."""
    given = Path(os.environ["MICRO_ROS_PATH"])
    shutil.copytree(given / "include", folder / "include")
    (folder / "libmicroros.a").symlink_to(given / "libmicroros.a")
    header = "config.h"
    changed = 0
    for file in (folder / "include").rglob(header):
        text = file.read_text()
        new = re.sub(rf"(#define {name}) .*", rf"\1 {value}", text)
        changed += new != text
        file.write_text(new)
    assert changed == 1
    return folder


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("RMW_UXRCE_MAX_PUBLISHERS", "6", "rebuild it with -DRMW_UXRCE_MAX_PUBLISHERS=7"),
        ("RMW_UXRCE_MAX_SUBSCRIPTIONS", "4", "rebuild it with -DRMW_UXRCE_MAX_SUBSCRIPTIONS=5"),
        ("RMW_UXRCE_MAX_TOPICS", "11", "components and communication make 12 topics"),
        ("RMW_UXRCE_MAX_HISTORY", "4", "rebuild libmicroros with -DRMW_UXRCE_MAX_HISTORY=5"),
        # For /lab/robot_$serial and /lab/robot_$serial/enable, with rt and a terminating zero
        ("RMW_UXRCE_NODE_NAME_MAX_LENGTH", "27", "rebuild it with -DRMW_UXRCE_NODE_NAME_MAX_LENGTH=28"),
        ("RMW_UXRCE_TOPIC_NAME_MAX_LENGTH", "36", "rebuild it with -DRMW_UXRCE_TOPIC_NAME_MAX_LENGTH=37"),
        ("UXR_CONFIG_CUSTOM_TRANSPORT_MTU", "512", "-DUCLIENT_CUSTOM_TRANSPORT_MTU=1536"),
    ],
)
def test_pools_that_are_too_small(tmp_path: Path, name: str, value: str, message: str) -> None:
    done = configure(tmp_path / "build")
    assert done.returncode == 0, done.stdout + done.stderr
    library = changed_library(tmp_path / "library", name, value)
    done = configure(tmp_path / "build", f"-DMICRO_ROS_PATH={library}")
    assert done.returncode == 0, done.stdout + done.stderr
    done = build(tmp_path / "build", "CMakeFiles/robot.dir/epg/robot/robot_app.c.o")
    assert done.returncode != 0
    assert message in done.stdout.replace('" "', "")
    assert done.stdout.count("error: static assertion failed") == 1


def test_a_folder_without_the_library(tmp_path: Path) -> None:
    done = configure(tmp_path / "build", f"-DMICRO_ROS_PATH={tmp_path}")
    assert done.returncode != 0
    assert "does not lead to the micro-ROS client library" in " ".join(done.stderr.split())
