# SPDX-License-Identifier: Apache-2.0
"""``tokens.xml`` alone as a model."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import load, loaded


def test_reads_everything(tmp_path: Path) -> None:
    model = loaded(Export(method="RungeKutta4").write_tokens(tmp_path))
    assert (model.name, model.origin, model.language) == ("Servo", "20-sim tokens", "c")
    assert [(p.name, p.unit) for p in model.inputs] == [("in", "rad"), ("position", "rad")]
    assert [(p.name, p.value, p.unit) for p in model.parameters][1] == ("PI1\\tauI", 0.8, "s")
    assert model.instantiable
    port = model.outputs[1]
    line = Path(port.span.file).read_text().splitlines()[port.span.line - 1]
    assert line[port.span.column - 1 :].startswith("y[1] =")


@pytest.mark.parametrize(
    ("export", "id"),
    [
        (Export(method="VodeAdams"), "model-variable-step"),
        (Export(token_values={"NUMBER_ALGLOOPS": "1"}), "model-algebraic-loop"),
        (Export(token_values={"NUMBER_MATRICES": "1"}), "model-tokens"),
        (Export(token_values={"DYNAMIC_EQUATIONS": "-"}), "model-tokens"),
        (Export(token_values={"STATIC_EQUATIONS": "} void evil (void) {"}), "model-tokens"),
        (Export(token_values={"STATIC_EQUATIONS": "#include </etc/passwd>\n"}), "model-tokens"),
        (Export(token_values={"STATIC_EQUATIONS": "\txx_V[0] = 1; /* open"}), "model-tokens"),
        (Export(token_values={"TIME_STEP_SIZE": "0"}), "model-step"),
        (Export(token_values={"NUMBER_INPUTS": "3"}), "model-ports"),
        (Export(dynamic='\tV[0] = XXTable ("a", V[1], 0);\n'), "model-stub"),
        (Export(dynamic="\tV[0] = XXRealTime ();\n"), "model-real-time"),
        (Export(dynamic="\tV[0] = XXAbsolut (V[1]);\n"), "model-tokens"),
        (Export(dynamic="\tV[0] = My_dll (V[1]);\n"), "model-dll"),
    ],
)
def test_refused(export: Export, id: str, tmp_path: Path) -> None:
    model, diagnostics = load(export.write_tokens(tmp_path))
    assert model is None
    assert [(item.severity, item.id) for item in diagnostics] == [("error", id)]
    assert diagnostics.items[0].hint and diagnostics.items[0].span.line > 0


NEEDED = ["VARPREFIX", "NUMBER_INPUTS", "NUMBER_VARIABLES", "NUMBER_STATES", "TIME_STEP_SIZE", "DYNAMIC_EQUATIONS"]


@pytest.mark.parametrize("count", [1, 2, len(NEEDED)])
def test_tokens_that_are_gone_are_named_at_once(count: int, tmp_path: Path) -> None:
    path = Export().write_tokens(tmp_path) / "tokens.xml"
    for name in NEEDED[:count]:
        path.write_text(re.sub(rf'<token name="{name}">.*?</token>', "", path.read_text(), flags=re.DOTALL))
    model, diagnostics = load(tmp_path)
    assert model is None and [item.id for item in diagnostics] == ["model-tokens"]
    assert all(f"'{name}'" in diagnostics.items[0].message for name in NEEDED[:count])


@pytest.mark.parametrize("name", ["NUMBER_VARIABLES", "NUMBER_STATES", "NUMBER_PARAMETERS", "NUMBER_INITIAL_VALUES"])
def test_arrays_that_are_too_small_are_refused(name: str, tmp_path: Path) -> None:
    """The equations would write beyond the end of the arrays."""
    model, diagnostics = load(Export(token_values={name: "1"}).write_tokens(tmp_path))
    assert model is None and {item.id for item in diagnostics} == {"model-tokens"}
    assert all(f"but '{name}' is 1" in item.message for item in diagnostics)


def test_a_file_that_is_cut_off(tmp_path: Path) -> None:
    path = Export().write_tokens(tmp_path) / "tokens.xml"
    text = path.read_text()
    path.write_text(text[: text.index("DYNAMIC_EQUATIONS") + 40])
    model, diagnostics = load(tmp_path)
    assert model is None and [item.id for item in diagnostics] == ["model-xml"]
    assert "the file ends before <token> 'DYNAMIC_EQUATIONS' does" in diagnostics.items[0].message
