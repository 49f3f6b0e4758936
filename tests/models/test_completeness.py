# SPDX-License-Identifier: Apache-2.0
"""Incomplete exports: EPG reports the missing parts before the linker does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import load

VARIABLES = ("xx_time", "xx_steps", "xx_initialize", "xx_major", "xx_stop_simulation", "xx_I", "xx_V", "xx_s", "xx_R")
CPP = Export(method="RungeKutta4", tokens=False)


def only_message(folder: Path) -> str:
    model, diagnostics = load(folder)
    assert model is None
    assert [item.id for item in diagnostics] == ["model-incomplete"], [item.message for item in diagnostics]
    assert diagnostics.items[0].hint
    return diagnostics.items[0].message


@pytest.mark.parametrize("name", VARIABLES)
def test_a_variable_that_is_gone(name: str, tmp_path: Path) -> None:
    folder = Export(method="RungeKutta4", tokens=False).write(tmp_path)
    source = folder / "xxmodel.c"
    text, count = re.subn(rf"^XX\w+ {name}\b[^;]*;", "", source.read_text(), count=1, flags=re.MULTILINE)
    assert count
    source.write_text(text)
    assert only_message(folder) == f"'{name}' is used, but no file of the export defines it"


@pytest.mark.parametrize(
    ("file", "head"),
    [
        ("Servo.cpp", "Servo::Servo("),
        ("Servo.cpp", "Servo::~Servo("),
        ("Servo.cpp", "void Servo::CalculateDynamic"),
        ("Servo.cpp", "void Servo::CalculateOutput"),
        ("Servo.cpp", "void Servo::CopyInputsToVariables"),
        ("common/xxinteg.cpp", "void RungeKutta4::Initialize"),
        ("common/xxinteg.cpp", "void RungeKutta4::Step"),
    ],
)
def test_a_method_that_is_gone(file: str, head: str, tmp_path: Path) -> None:
    folder = CPP.write_cpp(tmp_path)
    source = folder / file
    before, found, behind = source.read_text().partition(head)
    assert found
    source.write_text(before + behind[behind.index("\n}\n") + 3 :])
    name = re.split(r"::|\(", head)[1]
    assert only_message(folder).startswith(f"'{name}' is ")


def test_whole_exports_are_whole(tmp_path: Path) -> None:
    for number, method in enumerate(("Discrete", "Euler", "RungeKutta2", "RungeKutta4")):
        for prefix in ("xx_", "pan_"):
            export = Export(method=method, variable=prefix, tokens=False)
            assert load(export.write(tmp_path / f"{prefix}{number}"))[0] is not None
        assert load(Export(method=method).write_cpp(tmp_path / f"cpp{number}"))[0] is not None
