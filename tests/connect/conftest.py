# SPDX-License-Identifier: Apache-2.0
"""Fixtures: projects to connect; each test has its own copy."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.connect import robots
from tests.connect.page import Page, serving_pages, session_of
from tests.live.target import jiwy_host, target

__all__ = ["jiwy_host", "target"]


@pytest.fixture(scope="session")
def new_project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project that ``epg new`` writes for JIWY on a Raspberry Pi Pico."""
    return robots.new_project(tmp_path_factory.mktemp("new") / "robot", "rpi_pico_bare_metal_jiwy")


@pytest.fixture
def one_axis(tmp_path: Path) -> Path:
    """A new project for a Pico of a model with one axis for JIWY, which has two."""
    return robots.one_axis_project(tmp_path, "rpi_pico_bare_metal_jiwy")


@pytest.fixture
def project(new_project: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(new_project, tmp_path / "a robot"))


@pytest.fixture
def bindings(project: Path) -> Path:
    return project / "robot.bindings.yaml"


@pytest.fixture
def page(pages: Callable[[], Page]) -> Page:
    return pages()


@pytest.fixture
def pages(project: Path) -> Iterator[Callable[[], Page]]:
    """Opens pages of one session."""
    with serving_pages(session_of(project)) as open_page:
        yield open_page
