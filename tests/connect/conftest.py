# SPDX-License-Identifier: Apache-2.0
"""Fixtures: projects to connect; each test has its own copy."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.new.new_project import ProjectRequest, write_project
from tests.connect.page import Page, serving_pages, session_of
from tests.live.target import jiwy_host, target

__all__ = ["jiwy_host", "target"]

ROOT = Path(__file__).resolve().parent.parent.parent


@pytest.fixture(scope="session")
def new_project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The project that ``epg new`` writes for JIWY on a Raspberry Pi Pico."""
    folder = tmp_path_factory.mktemp("new") / "robot"
    request = ProjectRequest("robot", folder, "rpi_pico_bare_metal_jiwy", ROOT / "examples/jiwy/model")
    write_project(request, Diagnostics())
    return folder


@pytest.fixture
def one_axis(tmp_path: Path) -> Path:
    """A new project for a Pico of a model with one axis for JIWY, which has two."""
    return one_axis_project(tmp_path, "rpi_pico_bare_metal_jiwy")


def one_axis_project(tmp_path: Path, target: str) -> Path:
    model = tmp_path / "pan"
    model.mkdir()
    (model / "model.yaml").write_text(
        "version: 1\nstep: 1 ms\nheader: pan.h\nsources: [pan.c]\ntypes: {inputs: in_t, outputs: out_t}\n"
        "functions: {step: pan}\ninputs: {position_pan: {unit: rad}, setpoint_pan: {unit: rad}}\n"
        "outputs: {pwm_pan: {}}\n"
    )
    (model / "pan.h").write_text(
        "typedef struct { double position_pan, setpoint_pan; } in_t;\ntypedef struct { double pwm_pan; } out_t;\n"
        "void pan(const in_t *in, out_t *out);\n"
    )
    (model / "pan.c").write_text(
        '#include "pan.h"\nvoid pan(const in_t *in, out_t *out) { out->pwm_pan = in->setpoint_pan; }\n'
    )
    write_project(ProjectRequest("robot", tmp_path / "robot", target, model), Diagnostics())
    return tmp_path / "robot"


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
