# SPDX-License-Identifier: Apache-2.0
"""Import of C function exports, as 20-sim writes them and as developers change them."""

from __future__ import annotations

import re
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest

from epg.generator.importers.c_function.c_function_export import CFunctionExport
from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import load, loaded

PORTS = (["in", "position"], ["corr", "out"])


def names(model: object) -> tuple[list[str], list[str]]:
    return [p.name for p in model.inputs], [p.name for p in model.outputs]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "export",
    [
        Export(),
        Export(version="4.5.1.5561"),
        Export(version="4.7.0.8692", method="Euler"),
        Export(method="RungeKutta2"),
        Export(newline="\r\n"),
        Export(encoding="latin-1", user="Jérôme, Universität"),
        Export(tokens=False),
        Export(variable="Pan_", function="Pan", tokens=False),
        Export(variable="yy_", function="YY", tokens=False),
        Export(suffix="pan", tokens=False),
        Export(variable="", tokens=False),
    ],
    ids=["5.1", "4.5", "4.7", "rk2", "crlf", "latin-1", "no-tokens", "pan-prefix", "yy", "suffix", "no-prefix"],
)
def test_reads_everything(export: Export, tmp_path: Path) -> None:
    model, diagnostics = load(export.write(tmp_path / "model"))
    assert model is not None and not diagnostics.items
    assert names(model) == PORTS
    assert [p.unit for p in model.inputs] == ["rad", "rad"]
    assert [p.index for p in model.inputs] == [0, 1]
    assert (model.name, model.origin, model.language) == ("Servo", "20-sim C function", "c")
    assert (model.version, model.method, model.step) == (export.version, export.method, Fraction(1, 1000))
    assert [(p.name, p.value, p.unit) for p in model.parameters] == [
        ("PI1\\kp", 2.5, ""),
        ("PI1\\tauI", 0.8, "s"),
        ("Filter\\tau", 0.05, "s"),
        ("Limiter\\maximum", 0.95, ""),
    ]
    assert not model.instantiable


def test_positions_point_at_the_lines(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    model = loaded(folder)
    port = model.inputs[1]
    text = (folder / "xxsubmod.c").read_text().splitlines()[port.span.line - 1]
    assert text[port.span.column - 1 : port.span.end - 1] == "xx_V[5] = u[1];"


@pytest.mark.parametrize(
    ("text", "step"),
    [
        ("1e-3", Fraction(1, 1000)),
        ("5.0e-004", Fraction(1, 2000)),
        ("0.01f", Fraction(1, 100)),
        ("1.0 / 3000.0", Fraction(1, 3000)),
    ],
)
def test_step_sizes_are_exact(text: str, step: Fraction, tmp_path: Path) -> None:
    assert loaded(Export(step=text, tokens=False).write(tmp_path)).step == step


def test_only_files_the_model_needs_are_compiled(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    (folder / "driver.c").write_text('#include <fcntl.h>\nint open_device(void) { return open("/dev/x", 0); }\n')
    (folder / "app.c").write_text("int main(void) { return 0; }\ndouble xx_V[3];\n")
    model, diagnostics = load(folder)
    assert model is not None and not diagnostics.items
    used = {path.name for path in model.files}
    assert "xxfuncs.c" in used
    assert not used & {"driver.c", "app.c", "xxmain.c", "motionprofiles.c"}


def test_helper_file_is_left_out_where_nothing_is_used(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    model_c = folder / "xxmodel.c"
    model_c.write_text(model_c.read_text().replace("XXAbsolute (xx_s[1])", "xx_s[1]"))
    assert "xxfuncs.c" not in {path.name for path in loaded(folder).files}


def test_two_renamed_models_in_one_folder_are_told_apart(tmp_path: Path) -> None:
    for suffix in ("pan", "tilt"):
        rename = {
            f"xx{part}.{kind}": f"xx{part}{suffix}.{kind}" for part in ("submod", "model", "integ") for kind in "ch"
        }
        export = Export(name=f"Servo{suffix}", suffix=suffix, rename=rename, tokens=False)
        export.write(tmp_path)
        for part in ("submod", "model", "integ"):
            path = tmp_path / f"xx{part}{suffix}.c"
            text = path.read_text()
            for header in ("submod", "model", "integ"):
                text = text.replace(f'"xx{header}.h"', f'"xx{header}{suffix}.h"')
            path.write_text(text)
            path = tmp_path / f"xx{part}{suffix}.h"
            path.write_text(path.read_text().replace('"xxmodel.h"', f'"xxmodel{suffix}.h"'))
    shared = tmp_path / "xxfuncs.c"  # its stop flag belongs to the model that was exported last
    shared.write_text(re.sub(r"XXBoolean XXStopSimulation[^{]*\{.*?\n\}\n", "", shared.read_text(), flags=re.DOTALL))
    model, diagnostics = load(tmp_path)
    assert model is None
    assert [item.id for item in diagnostics] == ["model-ambiguous"]
    assert "xxsubmodpan.c, xxsubmodtilt.c" in diagnostics.items[0].hint
    pan = loaded(tmp_path / "xxsubmodpan.c")
    assert pan.name == "Servopan"
    assert {p.name for p in pan.files if p.suffix == ".c"} >= {"xxsubmodpan.c", "xxmodelpan.c", "xxintegpan.c"}
    assert not any("tilt" in path.name for path in pan.files)


def test_suffix_on_some_names_only(tmp_path: Path) -> None:
    folder = Export(tokens=False).write(tmp_path)
    for path in folder.glob("*.[ch]"):
        path.write_text(re.sub(r"\bxx_([PIVsR])\b", r"xx_\1pan", path.read_text()))
    model = loaded(folder)
    assert names(model) == PORTS and len(model.parameters) == 4
    details = model.code
    assert (details.parameters, details.states, details.state_count) == ("xx_Ppan", "xx_span", 2)  # type: ignore[attr-defined]


def test_renamed_integration_file(tmp_path: Path) -> None:
    folder = Export(method="Euler", rename={"xxinteg.c": "Euler.c", "xxinteg.h": "Euler.h"}).write(tmp_path)
    for name in ("xxsubmod.c", "Euler.c"):
        path = folder / name
        path.write_text(path.read_text().replace('"xxinteg.h"', '"Euler.h"'))
    assert loaded(folder).method == "Euler"


def test_step_passed_instead_of_time_is_seen(tmp_path: Path) -> None:
    folder = Export(tokens=False).write(tmp_path)
    path = folder / "xxsubmod.c"
    head, calculate = path.read_text().split("void XXCalculateSubmodel")
    path.write_text(head + "void XXCalculateSubmodel" + calculate.replace("xx_time = t;", "xx_step_size = t;", 1))
    model = loaded(folder)
    assert model.code.calculate.arguments == ("u", "y", "step")  # type: ignore[attr-defined]
    assert model.code.initialize.arguments == ("u", "y", "time")  # type: ignore[attr-defined]


def test_a_vector_without_a_name(tmp_path: Path) -> None:
    """C23 permits parameters without names, in a function that does not use them."""
    folder = Export().write(tmp_path)
    main = folder / "xxsubmod.c"
    text = main.read_text(encoding="utf-8")
    changed = text.replace("CalculateSubmodel (XXDouble *u,", "CalculateSubmodel (XXDouble *,")
    assert changed != text
    main.write_text(changed, encoding="utf-8")
    details = loaded(folder).code
    assert isinstance(details, CFunctionExport)
    assert details.calculate.arguments == ("u", "y", "time")


def test_reformatted_and_uncommented_source(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    path = folder / "xxsubmod.c"
    text = path.read_text()
    text = text.replace("\txx_V[4] = u[0];\t\t/* in {rad} */", "    xx_V[ 4 ]=u[ 0 ] ; // in {rad}")
    text = text.replace(
        "\txx_V[5] = u[1];\t\t/* position {rad} */", "    /* the next one */\n    xx_V[5]\n        = u[1];"
    )
    path.write_text(text)
    model = loaded(folder)
    assert names(model) == PORTS  # the second name comes from the list of names in the comment
    assert [p.unit for p in model.inputs] == ["rad", ""]


def test_names_fall_back_to_tokens_and_then_to_the_index(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    path = folder / "xxsubmod.c"
    path.write_text(path.read_text().replace("/* corr */", "").replace("/* out */", ""))
    assert names(loaded(folder)) == PORTS
    (folder / "tokens.xml").unlink()
    model, diagnostics = load(folder)
    assert model is not None and names(model) == (PORTS[0], ["y0", "y1"])
    assert [item.id for item in diagnostics] == ["model-port-unnamed"] * 2


def test_headers_in_another_case(tmp_path: Path) -> None:
    folder = Export(rename={"xxfuncs.h": "XXfuncs.h", "motionprofiles.h": "MotionProfiles.h"}).write(tmp_path)
    model, diagnostics = load(folder)
    assert model is not None and not diagnostics.items
    assert {shim.name for shim in model.code.linked.shims} == {"xxfuncs.h", "motionprofiles.h"}  # type: ignore[attr-defined]


def test_missing_files(tmp_path: Path) -> None:
    model, diagnostics = load(Export(omit=("motionprofiles.c", "motionprofiles.h")).write(tmp_path / "a"))
    assert model is not None
    assert [(item.severity, item.id) for item in diagnostics] == [("warning", "model-file-missing")]
    model, diagnostics = load(Export(omit=("xxtypes.h",)).write(tmp_path / "b"))
    assert model is None
    assert {item.id for item in diagnostics} == {"model-file-missing"}
    assert all(item.span.line > 1 for item in diagnostics)


def test_half_renamed_export(tmp_path: Path) -> None:
    folder = Export(tokens=False).write(tmp_path)
    path = folder / "xxsubmod.c"
    path.write_text(path.read_text().replace("XXModelInitialize ()", "XXModelInitializepan ()"))
    model, diagnostics = load(folder)
    assert model is None
    assert [item.id for item in diagnostics] == ["model-incomplete"]
    assert "'XXModelInitializepan'" in diagnostics.items[0].message


def test_definition_in_two_files(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    (folder / "copy_of_xxmodel.c").write_text((folder / "xxmodel.c").read_text())
    model, diagnostics = load(folder)
    assert model is None
    assert {item.id for item in diagnostics} == {"model-ambiguous-definition"}
    assert len(diagnostics.items[0].notes) == 2


def test_lost_port_line(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    path = folder / "xxsubmod.c"
    path.write_text(path.read_text().replace("\txx_V[5] = u[1];", "\t"))
    model, diagnostics = load(folder)
    assert model is None
    assert [item.id for item in diagnostics] == ["model-ports"]
    assert "2 inputs, but no line connects u[1]" in diagnostics.items[0].message


@pytest.mark.parametrize("step", ["0.0", "-0.001", "SAMPLE_TIME"])
def test_impossible_step_size(step: str, tmp_path: Path) -> None:
    model, diagnostics = load(Export(step=step, tokens=False).write(tmp_path))
    assert model is None
    assert [item.id for item in diagnostics] == ["model-step"]


def test_identifiers_of_ports(tmp_path: Path) -> None:
    ports = (("p.e", "V"), ("double", ""), ("PID\\error signal", ""))
    model = loaded(Export(inputs=INPUTS_OF_EXPORT, outputs=ports[:2], tokens=False).write(tmp_path / "a"))
    assert [p.identifier for p in model.outputs] == ["p_e", "double_"]
    model, diagnostics = load(Export(outputs=(("p.e", ""), ("p_e", "")), tokens=False).write(tmp_path / "b"))
    assert model is None
    assert [item.id for item in diagnostics] == ["model-port-collision"]
    assert "'p.e' and 'p_e'" in diagnostics.items[0].message


INPUTS_OF_EXPORT = Export().inputs


def test_no_inputs(tmp_path: Path) -> None:
    export = Export(inputs=(), tokens=False)
    assert loaded(export.write(tmp_path)).inputs == ()


def test_string_parameters_are_left_out(tmp_path: Path) -> None:
    folder = Export(tokens=False, declarations="XXDouble XXString2Double (const char* argument);").write(tmp_path)
    path = folder / "xxmodel.c"
    path.write_text(path.read_text().replace("xx_P[1] = 0.8;", 'xx_P[1] = XXString2Double ("file.txt");'))
    funcs = folder / "xxfuncs.c"
    funcs.write_text(funcs.read_text() + "XXDouble XXString2Double (const char* argument) { return argument != 0; }\n")
    assert [p.index for p in loaded(folder).parameters] == [0, 2, 3]


def test_truncated_and_mangled_sources_never_raise(tmp_path: Path) -> None:
    """A file cut anywhere gives a model or an error, and no other exception."""
    original = Export().c_files()
    folder = Export().write(tmp_path)
    for name in ("xxsubmod.c", "xxmodel.c", "xxmodel.h", "tokens.xml"):
        text = original[name]
        for cut in range(0, len(text), max(1, len(text) // 23)):
            (folder / name).write_text(text[:cut])
            model, diagnostics = load(folder)
            assert model is not None or diagnostics.has_errors
        (folder / name).write_text(text)
    assert loaded(replace(Export(), newline="\r\n").write(folder))
