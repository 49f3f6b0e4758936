# SPDX-License-Identifier: Apache-2.0
"""Files beside the sources: the data that they add, and the messages if they belong to another export."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tests.doubles.twenty_sim.exports import Export
from tests.models.fmus import pack
from tests.models.harness import load


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"INPUT_NAMES3": "in\nspeed\n"}, "inputs in, speed, but the sources have in, position"),
        ({"OUTPUT_NAMES3": "out\ncorr\n"}, "outputs in the order out, corr, but the sources have the order corr, out"),
        ({"TIME_STEP_SIZE": "0.01"}, "step size 0.01 s, but the sources have 0.001 s"),
        ({"INTEGRATION_METHOD_NAME": "Euler"}, "integration method 'Euler', but the sources have 'Discrete'"),
        ({"VARPREFIX": "pan_"}, "prefix 'pan_', but the sources have 'xx_'"),
        ({"SUBMODEL_NAME": "Tilt"}, "submodel 'Tilt', but the sources have 'Servo'"),
        ({"PARAMETER_NAMES3": "PI1\\kp\n"}, "no parameter 'PI1\\tauI', which the sources have"),
    ],
    ids=["names", "order", "step", "method", "prefix", "submodel", "parameters"],
)
def test_differences_are_named(values: dict[str, str], said: str, tmp_path: Path) -> None:
    model, diagnostics = load(Export(token_values=values).write(tmp_path))
    assert model is not None
    assert [(item.severity, item.id) for item in diagnostics] == [("warning", "stale-metadata")]
    problem = diagnostics.items[0]
    assert said in problem.message and "'tokens.xml'" in problem.message
    line = (tmp_path / "tokens.xml").read_text().splitlines()[problem.span.line - 1]
    assert next(iter(values)) in line
    assert Path(problem.notes[0].span.file).name == "xxsubmod.c"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "<tokens>",
        "<tokens><token name='A'>&undefined;</token></tokens>",
        '<!DOCTYPE t [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]><tokens><token name="A">&b;</token></tokens>',
        "<a>" * 200 + "</a>" * 200,
        "no xml at all",
        '<?xml version="1.0" encoding="no-such-encoding"?><tokens/>',
    ],
    ids=["empty", "open", "entity", "doctype", "deep", "text", "encoding"],
)
def test_broken_tokens_are_a_warning_beside_sources_and_an_error_alone(text: str, tmp_path: Path) -> None:
    folder = Export().write(tmp_path / "with")
    (folder / "tokens.xml").write_text(text)
    model, diagnostics = load(folder)
    assert model is not None
    assert [(item.severity, item.id) for item in diagnostics] == [("warning", "model-xml")]
    alone = tmp_path / "alone"
    alone.mkdir()
    (alone / "tokens.xml").write_text(text)
    model, diagnostics = load(alone)
    assert model is None
    assert [(item.severity, item.id) for item in diagnostics] == [("error", "model-xml")]


def configuration(**ports: str) -> str:
    variables = "".join(
        f"<modelVariable><name>{name}</name><kind>{'output' if name in ('corr', 'out') else 'input'}</kind>"
        f"<type>{kind}</type><description>the {name}</description>"
        f"<physical><unit><name>m</name></unit></physical></modelVariable>"
        for name, kind in ports.items()
    )
    return (
        "<modelConfiguration><general><name>Servo</name></general><run><stepSize>0.001</stepSize></run>"
        f"<modelVariables>{variables}</modelVariables></modelConfiguration>"
    )


def test_configuration_gives_types_units_and_descriptions(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    text = configuration(**{"position": "real", "in": "boolean", "out": "integer", "corr": "real"})
    (folder / "ModelConfiguration.xml").write_text(text)
    model, diagnostics = load(folder)
    assert model is not None and not diagnostics.items
    assert [(p.name, p.type, p.unit) for p in model.inputs] == [("in", "boolean", "rad"), ("position", "real", "rad")]
    assert [(p.type, p.unit, p.description) for p in model.outputs] == [
        ("real", "m", "the corr"),
        ("integer", "m", "the out"),
    ]


def test_stale_configuration_is_named(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    text = configuration(**{"in": "real", "speed": "real", "out": "real", "corr": "real"}).replace("0.001", "0.002")
    (folder / "ModelConfiguration.xml").write_text(text)
    model, diagnostics = load(folder)
    assert model is not None
    assert {item.id for item in diagnostics} == {"stale-metadata"}
    said = " ".join(item.message for item in diagnostics)
    assert "no input 'position'" in said and "the input 'speed'" in said and "step size 0.002" in said


def test_tokens_of_a_second_model_beside_it_are_not_used(tmp_path: Path) -> None:
    folder = Export().write_cpp(tmp_path)
    (folder / "Other_tokens.xml").write_text(Export(name="Other", step="0.5").tokens_xml())
    model, diagnostics = load(folder)
    assert model is not None and not diagnostics.items


@pytest.mark.parametrize("kind", ["c", "c++", "fmu sources"])
def test_other_values_of_parameters_are_named(kind: str, tmp_path: Path) -> None:
    """One warning at the value in the tokens, with both values; the model runs with the value in the sources."""
    other = (
        ("PI1\\kp", "2.5", ""),
        ("PI1\\tauI", "8e-1", "s"),
        ("Filter\\tau", "0.5", "s"),
        ("Limiter\\maximum", "1", ""),
    )
    lines = replace(Export(), parameters=other, variable="m_" if kind == "c++" else "xx_").parameter_lines()
    export = Export(token_values={"INITIALIZE_PARAMETERS": lines})
    if kind == "fmu sources":
        export.write_fmu(tmp_path, True)
    else:
        (export.write if kind == "c" else export.write_cpp)(tmp_path)
    model, diagnostics = load(tmp_path)
    assert model is not None
    assert [parameter.value for parameter in model.parameters] == [2.5, 0.8, 0.05, 0.95]
    (problem,) = diagnostics.items
    assert (problem.severity, problem.id) == ("warning", "stale-metadata")
    assert "has parameter 'Filter\\tau' = 0.5, but the sources have 0.05, and 1 more differs" in problem.message
    assert "EPG uses the sources" in problem.hint
    line = Path(problem.span.file).read_text().splitlines()[problem.span.line - 1]
    assert line.strip().startswith(("xx_P[2] = 0.5;", "m_P[2] = 0.5;"))
    texts = []
    for note in problem.notes:
        texts.append(Path(note.span.file).read_text().splitlines()[note.span.line - 1].strip())
    assert [text.partition("P")[2].partition(";")[0] for text in texts] == ["[2] = 5.0e-2", "[3] = 0.95"]
    assert problem.notes[1].message == "'Limiter\\maximum' is 1.0 there, but 0.95 here"


def test_a_value_that_was_changed_in_one_place_of_the_tokens(tmp_path: Path) -> None:
    values = "2.5\n0.8\n0.050\n0.9\n"
    _, diagnostics = load(Export(token_values={"PARAMETER_VALUES": values}).write(tmp_path))
    (problem,) = diagnostics.items
    assert "has parameter 'Limiter\\maximum' = 0.9, but the sources have 0.95" in problem.message
    assert "more" not in problem.message
    assert (tmp_path / "tokens.xml").read_text().splitlines()[problem.span.line - 1] == "0.9"


@pytest.mark.parametrize("archive", [False, True], ids=["folder", "archive"])
def test_other_values_in_the_description_of_an_fmu(archive: bool, tmp_path: Path) -> None:
    """Such values are not set: the FMU runs with those of its sources."""
    folder = Export(method="Euler").write_whole_fmu(tmp_path / "fmu", "output time")
    assert not load(folder)[1].items
    description = folder / "modelDescription.xml"
    description.write_text(description.read_text().replace('start="2.5"', 'start="4.0"'))
    model, diagnostics = load(pack(folder, tmp_path / "a.fmu") if archive else folder)
    assert model is not None
    assert {p.name: p.value for p in model.parameters}["PI1.kp"] == 2.5
    (problem,) = diagnostics.items
    assert (problem.severity, problem.id) == ("warning", "stale-metadata")
    assert "'modelDescription.xml' has parameter 'PI1.kp' = 4.0, but the sources have 2.5" in problem.message
    assert 'start="4.0"' in description.read_text().splitlines()[problem.span.line - 1]
    assert problem.notes[0].span.file.endswith("xxmodel.c")
