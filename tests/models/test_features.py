# SPDX-License-Identifier: Apache-2.0
"""Features of models that targets cannot run: refused on such targets, and only there."""

from __future__ import annotations

from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostic
from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import load

WARNING = (
    "#if defined __GNUC__\n#warning This model contains {}. Solving is not implemented in this template.\n#endif\n"
)


def only_problem(folder: Path, severity: str) -> Diagnostic:
    model, diagnostics = load(folder)
    assert (model is None) == (severity == "error")
    assert len(diagnostics.items) == 1, [item.message for item in diagnostics]
    problem = diagnostics.items[0]
    assert problem.severity == severity and problem.hint
    assert problem.span.line > 0 and problem.span.column > 0
    return problem


def text_at(problem: Diagnostic) -> str:
    line = Path(problem.span.file).read_text().splitlines()[problem.span.line - 1]
    return line[problem.span.column - 1 : problem.span.end - 1]


CALL = "\tV[0] = {};\n"


@pytest.mark.parametrize(
    ("export", "severity", "id", "at"),
    [
        (Export(method="MeBDFi", tokens=False), "error", "model-variable-step", "XXMeBDFi"),
        (Export(method="VodeAdams", tokens=False), "error", "model-variable-step", "XXVodeAd"),
        (Export(model=WARNING.format("dependent states")), "error", "model-dependent-states", "warning"),
        (Export(model=WARNING.format("algebraic loops")), "error", "model-algebraic-loop", "warning"),
        (Export(model=WARNING.format("constraint variables")), "error", "model-constraint", "warning"),
        (Export(model="#warning check the units\n"), "warning", "model-warning", "warning"),
        (Export(dynamic='\tV[0] = XXTable ("a.txt", V[1], 0);\n'), "error", "model-stub", "XXTable"),
        (Export(dynamic="\tV[0] = XXRandom (1.0);\n"), "warning", "model-random", "rand"),
        (Export(dynamic="\tV[0] = (XXDouble) time_of_day ();\n"), "error", "model-dll", "time_of_day"),
        (Export(dynamic="\tV[0] = XXUnknown (V[1]);\n"), "error", "model-incomplete", "XXUnknown"),
        (Export(dynamic='\tprintf ("%g", V[0]);\n'), "warning", "model-prints", "printf"),
        (Export(dynamic="\tV[0] = *(double *) malloc (8);\n"), "error", "model-heap", "malloc"),
        (Export(dynamic='\tfopen ("a", "r");\n'), "error", "model-file-use", "fopen"),
        (Export(dynamic="\tV[0] = clock ();\n"), "warning", "model-real-time", "clock"),
        (Export(real="float", tokens=False), "warning", "model-single-precision", "float"),
        (Export(token_values={"NUMBER_DEPSTATES": "1"}), "error", "model-dependent-states", ""),
        (Export(token_values={"NUMBER_ALGLOOPS": "2"}), "error", "model-algebraic-loop", ""),
        (Export(token_values={"NUMBER_CONSTRAINTS": "1"}), "error", "model-constraint", ""),
    ],
    ids=lambda value: value if isinstance(value, str) and value else "",
)
def test_refused_or_warned(export: Export, severity: str, id: str, at: str, tmp_path: Path) -> None:
    problem = only_problem(export.write(tmp_path), severity)
    assert problem.id == id
    if at:
        assert text_at(problem).startswith(at)
    else:
        assert Path(problem.span.file).name == "tokens.xml"


def test_a_stub_names_where_it_is_empty(tmp_path: Path) -> None:
    export = Export(dynamic='\tV[0] = XXTable ("a.txt", V[1], 0);\n')
    problem = only_problem(export.write(tmp_path), "error")
    assert "table()" in problem.message
    assert Path(problem.notes[0].span.file).name == "xxfuncs.c"


def test_an_implemented_stub_is_fine(tmp_path: Path) -> None:
    folder = Export(dynamic='\tV[0] = XXTable ("a.txt", V[1], 0);\n').write(tmp_path)
    funcs = folder / "xxfuncs.c"
    text = funcs.read_text()
    funcs.write_text(text.replace("XXInteger id)\n{\n\treturn 0;", "XXInteger id)\n{\n\treturn 2.0 * argument;"))
    model, diagnostics = load(folder)
    assert model is not None and not diagnostics.items


def test_code_that_does_not_run_is_not_refused(tmp_path: Path) -> None:
    functions = '#include <stdio.h>\nvoid *XXLoad (void)\n{\n#warning files\n\treturn fopen ("a", "r");\n}\n'
    model, diagnostics = load(Export(functions=functions).write(tmp_path))
    assert model is not None and not diagnostics.items


def test_a_file_with_the_dll_function_makes_it_part_of_the_model(tmp_path: Path) -> None:
    export = Export(dynamic="\tV[0] = Lookup_value (V[1]);\n", declarations="double Lookup_value (double x);")
    folder = export.write(tmp_path)
    (folder / "lookup.c").write_text("double Lookup_value (double x)\n{\n\treturn x * x;\n}\n")
    model, diagnostics = load(folder)
    assert model is not None and not diagnostics.items
    assert "lookup.c" in {path.name for path in model.files}


def test_a_function_that_no_header_declares(tmp_path: Path) -> None:
    folder = Export(dynamic="\tV[0] = Lookup_value (V[1]);\n").write(tmp_path)
    (folder / "lookup.c").write_text("double Lookup_value (double x)\n{\n\treturn x * x;\n}\n")
    assert only_problem(folder, "error").id == "model-undeclared"


def test_counts_of_stale_tokens_are_not_believed(tmp_path: Path) -> None:
    export = Export(token_values={"NUMBER_DEPSTATES": "1", "INPUT_NAMES3": "in\nspeed\n"})
    assert only_problem(export.write(tmp_path), "warning").id == "stale-metadata"


READER = """
#include <fstream>
#include <string>
#include <vector>
static double gain_of(const char *name)
{
\tstd::ifstream file(name);
\tstd::string line;
\tstd::vector<double> values(3);
\twhile (std::getline(file, line)) values.push_back(std::stod(line));
\treturn values.at(0);
}
"""


@pytest.mark.parametrize("spaces", ["std::", ""])
def test_a_class_that_reads_a_file_is_refused_for_that_alone(tmp_path: Path, spaces: str) -> None:
    folder = Export(dynamic='\tm_V[0] = gain_of("gains.txt");\n').write_cpp(tmp_path)
    source = folder / "Servo.cpp"
    reader = READER.replace("std::", spaces).replace(
        "static", "using namespace std;\nstatic" if not spaces else "static"
    )
    source.write_text(source.read_text().replace('#include "Servo.h"\n', f'#include "Servo.h"\n{reader}'))
    problem = only_problem(folder, "error")
    assert problem.id == "model-file-use" and problem.message.startswith("the model uses std::ifstream:")
    assert text_at(problem) == f"{spaces}ifstream"


def test_classes_that_take_memory_are_one_error(tmp_path: Path) -> None:
    code = '\t{ std::vector<double> v(3); std::string s("a"); m_V[0] = v[0] + s.size(); }\n'
    problem = only_problem(Export(dynamic=code).write_cpp(tmp_path), "error")
    assert problem.id == "model-heap" and problem.message == "the model uses std::vector (std::string too)"


def test_objects_and_functions_of_the_library_are_no_missing_functions(tmp_path: Path) -> None:
    code = (
        "\t{ struct Gain { double k; Gain(double x) { k = x; } }; Gain gain(2.0); m_V[0] = std::max(gain.k, 1.0); }\n"
    )
    model, diagnostics = load(Export(dynamic=code).write_cpp(tmp_path))
    assert model is not None, [item.message for item in diagnostics]


def test_a_file_is_one_error_however_it_is_used(tmp_path: Path) -> None:
    code = '\t{ FILE *f = fopen ("a", "r"); fscanf (f, "%lf", V); fclose (f); fclose (f); }\n'
    problem = only_problem(Export(dynamic=code).write(tmp_path), "error")
    assert problem.message == "the model calls fopen() (fclose(), fscanf() too): a target has no files"
    assert text_at(problem) == "fopen"
