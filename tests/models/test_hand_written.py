# SPDX-License-Identifier: Apache-2.0
"""Controllers written by hand, described by model.yaml."""

from __future__ import annotations

import shutil
from fractions import Fraction
from pathlib import Path

import pytest
import yaml

from epg.generator.importers.by_hand.hand_written_names import Names, integer_range, is_integer
from tests.models.harness import MODELS, load, loaded


def test_reads_everything() -> None:
    model = loaded(MODELS / "pid_c")
    assert (model.name, model.origin, model.language, model.step) == ("pid", "hand-written", "c", Fraction(1, 500))
    assert [(p.name, p.unit, p.type, p.index) for p in model.inputs] == [
        ("setpoint", "rad", "real", 0),
        ("position", "rad", "real", 1),
        ("enable", "", "boolean", 2),
        ("limit", "", "integer", 3),
    ]
    assert [(p.name, p.type) for p in model.outputs] == [
        ("duty", "real"),
        ("steps", "integer"),
        ("saturated", "boolean"),
    ]
    assert [(p.name, p.identifier, p.value, p.unit) for p in model.parameters] == [
        ("kp", "kp", 2.0, "1/rad"),
        ("integral rate", "integral_rate", 0.125, ""),
    ]
    assert model.instantiable
    assert {path.name for path in model.files} == {"model.yaml", "pid.c", "pid.h"}
    assert model.inputs[1].span.line == 12


def test_defaults() -> None:
    model = loaded(MODELS / "gain_arrays")
    assert model.name == "gain_arrays" and not model.instantiable and model.step == Fraction(1, 2000)


BASE = {
    "version": 1,
    "step": "1 ms",
    "header": "a.h",
    "sources": ["a.c"],
    "style": "arrays",
    "functions": {"step": "a_step"},
    "inputs": {"in": {"unit": "rad"}},
    "outputs": {"out": None},
}


def write(folder: Path, document: object) -> Path:
    (folder / "model.yaml").write_text(
        document if isinstance(document, str) else yaml.safe_dump(document, sort_keys=False)
    )
    (folder / "a.c").write_text('#include "a.h"\nvoid a_step(const double *u, double *y) { y[0] = u[0]; }\n')
    (folder / "a.h").write_text("void a_step(const double *u, double *y);\n")
    return folder


def test_base_is_good(tmp_path: Path) -> None:
    loaded(write(tmp_path, BASE))


WRONG = [
    ({"version": 2}, "newer-version"),
    ({"version": "one"}, "wrong-value"),
    ({"step": "1"}, "wrong-unit"),
    ({"step": 1}, "wrong-unit"),
    ({"step": "1 kg"}, "wrong-unit"),
    ({"step": "0 ms"}, "out-of-range"),
    ({"step": "-1 ms"}, "out-of-range"),
    ({"step": None}, "wrong-quantity"),
    ({"header": "b.h"}, "file-not-found"),
    ({"header": 3}, "wrong-type"),
    ({"sources": []}, "wrong-value"),
    ({"sources": "a.c"}, "wrong-type"),
    ({"sources": ["b.c"]}, "file-not-found"),
    ({"sources": ["a.h"]}, "wrong-value"),
    ({"style": "structs"}, "wrong-value"),
    ({"functions": {"init": "a_step"}}, "missing-key"),
    ({"functions": {"step": "a step"}}, "wrong-value"),
    ({"functions": {"step": "a_step", "run": "a_step"}}, "unknown-key"),
    ({"functions": ["a_step"]}, "wrong-type"),
    ({"inputs": {"in put": {}}}, "invalid-name"),
    ({"inputs": {"double": {}}}, "invalid-name"),
    ({"inputs": {"in": {"unit": 3}}}, "wrong-type"),
    ({"inputs": {"in": {"type": "bool"}}}, "wrong-value"),
    ({"inputs": {"in": {"units": "rad"}}}, "unknown-key"),
    ({"inputs": {"in": "rad"}}, "wrong-type"),
    ({"inputs": ["in"]}, "wrong-type"),
    ({"outputs": None, "parameters": {"k": {}}}, "missing-key"),
    ({"parameters": {"k": "2"}}, "wrong-type"),
    ({"parameters": {"k": {"value": True}}}, "wrong-type"),
    ({"parameters": {"k": {"value": 1, "member": "a b"}}}, "wrong-value"),
    ({"parameters": {"a b": 1}}, "invalid-name"),
    ({"instance": "a b"}, "wrong-value"),
    ({"types": {"inputs": "x_t"}}, "unknown-key"),
    ({"language": "c++"}, "wrong-value"),
    ({"language": "rust"}, "wrong-value"),
    ({"include_dirs": ["nowhere"]}, "file-not-found"),
    ({"ports": {}}, "unknown-key"),
]


@pytest.mark.parametrize(("change", "id"), WRONG, ids=[f"{next(iter(c))}-{i}-{n}" for n, (c, i) in enumerate(WRONG)])
def test_wrong(change: dict[str, object], id: str, tmp_path: Path) -> None:
    model, diagnostics = load(write(tmp_path, {**BASE, **change}))
    assert model is None
    assert id in {item.id for item in diagnostics}, [(item.id, item.message) for item in diagnostics]
    problem = next(item for item in diagnostics if item.id == id)
    line = (tmp_path / "model.yaml").read_text().splitlines()[problem.span.line - 1]
    at = line[problem.span.column - 1 :]
    assert any(at.startswith((str(word), repr(word).lower(), "[]", "- ", "null", "a.c")) for word in _words(change)), (
        line
    )


@pytest.mark.parametrize("key", ["version", "step", "header", "sources", "functions", "outputs"])
def test_missing(key: str, tmp_path: Path) -> None:
    model, diagnostics = load(write(tmp_path, {name: value for name, value in BASE.items() if name != key}))
    assert model is None
    assert [item.id for item in diagnostics] == ["missing-key"]
    assert f"'{key}'" in diagnostics.items[0].message


def test_struct_style_needs_types(tmp_path: Path) -> None:
    model, diagnostics = load(write(tmp_path, {**BASE, "style": "struct"}))
    assert model is None
    assert [item.id for item in diagnostics] == ["missing-key"]
    assert "types" in diagnostics.items[0].hint


@pytest.mark.parametrize("text", ["", "[]", "3", "a: [", "version: 1\nversion: 1\n"])
def test_no_map_at_all(text: str, tmp_path: Path) -> None:
    model, diagnostics = load(write(tmp_path, text))
    assert model is None and diagnostics.has_errors


def test_everything_is_reported_at_once(tmp_path: Path) -> None:
    model, diagnostics = load(write(tmp_path, {**BASE, "step": "1", "style": "x", "inputs": {"a b": {}}, "extra": 1}))
    assert model is None
    assert {item.id for item in diagnostics} == {"wrong-unit", "wrong-value", "invalid-name", "unknown-key"}


def _words(value: object) -> list[object]:
    if isinstance(value, dict):
        return [word for key, child in value.items() for word in [key, *_words(child)]]
    if isinstance(value, list):
        return [word for child in value for word in _words(child)]
    return [value]


def changed(folder: Path, name: str, **files: tuple[str, str]) -> Path:
    """A copy of one of the tests' models with one change in each file; ``_`` replaces the dot in a file's name."""
    shutil.copytree(MODELS / name, folder)
    for file, (old, new) in files.items():
        path = folder / file.replace("_", ".")
        assert old in path.read_text()
        path.write_text(path.read_text().replace(old, new))
    return folder


MISSPELT = [
    ("pid_c", "pid_step,", "pid_stpe,", "wrong-value", "pid_step"),
    ("pid_c", "pid_end", "pid_ends", "wrong-value", "pid_end"),
    ("pid_c", "instance: pid_t", "instance: pid_tt", "wrong-value", "pid_t"),
    ("pid_c", "outputs: pid_outputs_t", "outputs: pid_output_t", "wrong-value", "pid_outputs_t"),
    ("pid_c", "member: integral.rate", "member: integral.rates", "wrong-value", "rate"),
    ("pid_c", "member: integral.rate", "member: integrals.rate", "wrong-value", "integral"),
    ("pid_c", "  kp:", "  kpp:", "wrong-value", "kp"),
    ("pid_c", "  setpoint:", "  setpiont:", "wrong-value", "setpoint"),
    ("pid_cpp", "control::advance", "control::advanse", "wrong-value", "advance"),
    ("pid_cpp", "control::Filter", "control::Filtre", "wrong-value", "Filter"),
    ("pid_cpp", "{gain:", "{gian:", "wrong-value", "gain"),
    ("gain_arrays", "{gain: {", "{gian: {", "wrong-value", "gain"),
]


@pytest.mark.parametrize(("name", "old", "new", "id", "meant"), MISSPELT, ids=[f"{m[0]}-{m[2]}" for m in MISSPELT])
def test_a_misspelt_name_is_told_where_it_is_written(
    name: str, old: str, new: str, id: str, meant: str, tmp_path: Path
) -> None:
    folder = changed(tmp_path / "model", name, model_yaml=(old, new))
    model, diagnostics = load(folder)
    assert model is None
    assert [(item.id, item.hint) for item in diagnostics] == [(id, f"did you mean '{meant}'?")]
    span = diagnostics.items[0].span
    at = (folder / "model.yaml").read_text().splitlines()[span.line - 1][span.column - 1 : span.end - 1]
    assert at.strip('"') in new


def test_a_function_that_no_source_defines(tmp_path: Path) -> None:
    folder = changed(tmp_path / "model", "pid_c", pid_c=("void pid_step", "void pid_step2"))
    model, diagnostics = load(folder)
    assert model is None
    assert [item.id for item in diagnostics] == ["model-incomplete"]
    (folder / "more.c").write_text('#include "pid.h"\nvoid pid_step(void) {}\n')
    _, diagnostics = load(folder)
    assert diagnostics.items[0].hint == "add that file to 'sources'"
    assert [Path(note.span.file).name for note in diagnostics.items[0].notes] == ["more.c"]


@pytest.mark.parametrize(
    "unknown",
    ['#include "sdk_of_somebody.h"\n', "#include <sdk/of_somebody.h>\n", "#define F(x) void pid_##x(void)\n"],
)
def test_what_cannot_be_known_is_not_judged(unknown: str, tmp_path: Path) -> None:
    folder = changed(tmp_path / "model", "pid_c", model_yaml=("pid_step,", "pid_other,"))
    (folder / "pid.h").write_text(unknown + (folder / "pid.h").read_text())
    assert load(folder)[0] is not None


def test_functions_in_headers_and_included_files(tmp_path: Path) -> None:
    folder = write(tmp_path, BASE)
    (folder / "law.h").write_text("static inline void a_step(const double *u, double *y) { y[0] = u[0]; }\n")
    (folder / "a.h").write_text('#include <math.h>\n#include "law.h"\n')
    (folder / "a.c").write_text('#include "a.h"\n')
    loaded(folder)
    (folder / "a.h").write_text("void a_step(const double *u, double *y);\n")
    (folder / "a.c").write_text('#include "law.h"\n')
    loaded(folder)


def test_members_that_macros_or_a_base_declare(tmp_path: Path) -> None:
    folder = changed(tmp_path / "model", "pid_c", pid_h=("    double kp;\n", "    GAIN(kp);\n"))
    (folder / "pid.h").write_text("#define GAIN(x) double x\n" + (folder / "pid.h").read_text())
    loaded(folder)
    base = "struct Base { double gain = 0.0; };\nstruct Filter : Base {"
    other = changed(tmp_path / "other", "pid_cpp", controller_hpp=("struct Filter {", base))
    path = other / "controller.hpp"
    path.write_text(path.read_text().replace("{\n    double gain = 0.0;\n", "{\n"))
    loaded(other)


FIELDS = """
struct Base_less {
public:
    unsigned int mode : 3, level : WIDTH; int : 4;
    const volatile std::int8_t trim:(0x2);
protected: bool on : 1;
private slots:
    double plain;
    uint64_t count, *list, table[3];
    struct { unsigned deep : 5; } inner;
};
#define WIDTH 6
"""


def test_declarations_of_members(tmp_path: Path) -> None:
    (tmp_path / "a.h").write_text(FIELDS)
    names = Names(tmp_path, "a.h", [tmp_path], [], True)
    found = {}
    for member in ("mode", "level", "trim", "on", "inner.deep"):
        declaration = names.declaration("Base_less", member)
        assert declaration is not None
        found[member] = integer_range(declaration, names.number(declaration.width))
    assert found == {"mode": (0, 7), "level": (0, 63), "trim": (-2, 1), "on": (0, 1), "inner.deep": (0, 31)}
    assert [names.declaration("Base_less", name).width for name in ("plain", "count", "table[2]")] == ["", "", ""]  # type: ignore[union-attr]
    assert names.declaration("Base_less", "list") is None and names.declaration("other_t", "mode") is None
    assert is_integer(names.declaration("Base_less", "count")) and not is_integer(  # type: ignore[arg-type]
        names.declaration("Base_less", "plain")  # type: ignore[arg-type]
    )
    assert {"int", "unsigned", "slots", "private"}.isdisjoint(names.structs["Base_less"].members)
