# SPDX-License-Identifier: Apache-2.0
"""Import of C++ class exports."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import load


@pytest.mark.parametrize("export", [Export(), Export(method="Euler", newline="\r\n"), Export(tokens=False)])
def test_reads_everything(export: Export, tmp_path: Path) -> None:
    model, diagnostics = load(export.write_cpp(tmp_path))
    assert model is not None and not diagnostics.items
    assert (model.name, model.origin, model.language) == ("Servo", "20-sim C++ class", "c++")
    assert (model.version, model.method, model.step) == (export.version, export.method, Fraction(1, 1000))
    assert [(p.name, p.unit) for p in model.inputs] == [("in", "rad"), ("position", "rad")]
    assert [p.name for p in model.outputs] == ["corr", "out"]
    assert [p.name for p in model.parameters] == ["PI1\\kp", "PI1\\tauI", "Filter\\tau", "Limiter\\maximum"]
    assert model.instantiable
    assert not {path.name for path in model.files} & {"test_Servo.cpp"}


def test_new_while_running_is_refused(tmp_path: Path) -> None:
    folder = Export(dynamic="\t{ XXDouble *more = new XXDouble[2]; m_V[0] = more[0]; }\n").write_cpp(tmp_path)
    model, diagnostics = load(folder)
    assert model is None
    assert [item.id for item in diagnostics] == ["model-heap"]


def test_variable_step_method_of_stale_tokens_is_only_a_warning(tmp_path: Path) -> None:
    model, diagnostics = load(Export(token_values={"INTEGRATION_METHOD_NAME": "BDF"}).write_cpp(tmp_path))
    assert model is not None and model.method == "Discrete"
    assert [(item.severity, item.id) for item in diagnostics] == [("warning", "stale-metadata")]
    assert "'BDF'" in diagnostics.items[0].message and "'Discrete'" in diagnostics.items[0].message


def test_unknown_method_of_the_class_is_refused(tmp_path: Path) -> None:
    model, diagnostics = load(Export(method="BDF").write_cpp(tmp_path))
    assert model is None
    assert [item.id for item in diagnostics] == ["model-variable-step"]
    span = diagnostics.items[0].span
    line = Path(span.file).read_text().splitlines()[span.line - 1]
    assert line[span.column - 1 : span.end - 1] == "BDF"
