# SPDX-License-Identifier: Apache-2.0
"""A robot of three axes with limit switches, guards and an emergency stop, built in the page by keyboard alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.connect.robots import axes_project

from .served import Served
from .test_components import build_robot


def test_a_robot_of_three_axes_by_keyboard(browser: Any, open_page: Callable[..., Any], tmp_path: Path) -> None:
    axes = ("x", "y", "z")
    folder = axes_project(tmp_path, axes)
    with Served(folder) as served:
        build_robot(served, open_page(served.address), folder, axes)
