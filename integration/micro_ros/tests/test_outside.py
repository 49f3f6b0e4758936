# SPDX-License-Identifier: Apache-2.0
"""The middleware is complete in its folder: no other file of EPG names it."""

from __future__ import annotations

import re

from tests.checkout import ROOT, listed

FOLDER = "integration/micro_ros/"
WORD = re.compile(r"micro[-_ ]?ros", re.IGNORECASE)
OF_ROS = re.compile(r"micro_ros_agent|micro-ros-agent|micro_ros_setup|microros_ws|micro-ROS agent", re.IGNORECASE)
"""Names of the agent of ROS 2, which ``xrce`` uses, too: its package and program, the image of Docker, the package that
builds it, the workspace for that, its title."""
ALLOWED = {
    "CHANGELOG.md": "history",
    "CITATION.cff": "title of the thesis; keyword for searches",
    "pyproject.toml": "keyword for searches",
    "examples/network_situations/README.md": "title of the thesis",
    "docs/ros2-overview.md": "the page of all middlewares for ROS 2",
    "docs/agent.md": "ROS 2's addresses for the agent: github.com/micro-ROS, microros/micro-ros-agent",
    "tests/mutants/record/c.yaml": "written by a program, with the name of each file",
    "tests/mutants/record/templates.yaml": "written by a program, with the name of each file",
}
"""The files that may name it, with the reasons."""


def test_no_other_file_names_it() -> None:
    naming = {}
    for name in listed("--cached", "--others", "--exclude-standard"):
        text = f"{name}\n{(ROOT / name).read_bytes().decode('utf-8', 'replace')}"
        if not name.startswith(FOLDER) and (found := WORD.findall(OF_ROS.sub("", text))):
            naming[name] = found
    assert naming.keys() == ALLOWED.keys()
