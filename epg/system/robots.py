# SPDX-License-Identifier: Apache-2.0
"""The targets of a system for the tools for ROS 2, which otherwise read the descriptions in build folders."""

from __future__ import annotations

import json

from epg.generator.emit.application import Emitter
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.description import describe
from epg.runs.robot import Robot, robot_of
from epg.system.check_system import CheckedSystem


def robots_of(checked: CheckedSystem) -> list[Robot]:
    """The targets with their topics, as their descriptions would name them."""
    texts = [describe(Emitter(app, checked.loader.roots), PathNames(None)) for app in checked.applications.values()]
    return [robot_of(checked.system.path, json.loads(text)) for text in texts]


def boards_of(checked: CheckedSystem) -> dict[str, list[str]]:
    """The serial numbers of the boards that the file names, by target."""
    return {name: [target.serial] for name, target in checked.system.targets.items() if target.serial is not None}
