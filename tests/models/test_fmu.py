# SPDX-License-Identifier: Apache-2.0
"""FMUs: the data that EPG reads from folders and archives, and the messages for FMUs that it cannot use."""

from __future__ import annotations

import io
import struct
import tracemalloc
import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest
import yaml

from epg.generator.documents.source_file import SourceFile
from epg.generator.importers.fmu.fmu_export import FmuExport
from epg.generator.models.c_code import CFile, parse_code
from tests.doubles.twenty_sim.exports import Export
from tests.models.fmus import FMU2, FMU3, changed, pack
from tests.models.harness import HAVE_COMPILER, build, load, loaded, run_wrapper
from tests.waiting import calls


def only_error(path: Path) -> tuple[str, str]:
    model, diagnostics = load(path)
    assert model is None
    errors = [item for item in diagnostics if item.severity == "error"]
    assert len(errors) == 1, [item.message for item in errors]
    assert errors[0].hint or errors[0].id in ("wrong-type", "wrong-value")
    return errors[0].id, errors[0].message


@pytest.mark.parametrize("archive", [False, True], ids=["folder", "archive"])
def test_reads_everything(archive: bool, tmp_path: Path) -> None:
    model = loaded(pack(FMU2, tmp_path / "servo.fmu") if archive else FMU2)
    assert (model.name, model.origin, model.language) == ('Servo "1"', "FMI 2.0 FMU", "c")
    assert model.step == Fraction(1, 1000) and model.instantiable
    assert [(p.name, p.identifier, p.unit, p.type, p.index) for p in model.inputs] == [
        ("plant.setpoint", "plant_setpoint", "rad", "real", 0),  # the unit of its declared type
        ("plant.position", "plant_position", "rad", "real", 1),
        ("enable", "enable", "", "boolean", 2),
        ("mode", "mode", "", "integer", 3),
    ]
    assert model.inputs[1].description == "measured"
    assert [(p.name, p.unit, p.type) for p in model.outputs] == [
        ("duty", "", "real"),
        ("steps", "", "integer"),
        ("saturated", "", "boolean"),
    ]
    assert [(p.name, p.identifier, p.value, p.unit) for p in model.parameters] == [
        ("PI.kp", "PI_kp", 2.0, ""),
        ("PI.ki", "PI_ki", 0.5, "1/s"),
        ("table size", "table_size", 4.0, ""),
    ]
    assert [p.tunable for p in model.parameters] == [True, True, False]
    line = model.inputs[0].span.line
    assert 'name="plant.setpoint"' in (FMU2 / "modelDescription.xml").read_text().splitlines()[line - 1]
    names = {path.name for path in model.files}
    assert names == ({"servo.fmu"} if archive else {"modelDescription.xml", "servo.c", "law.c", "law.h"})


def test_reads_fmi_3(tmp_path: Path) -> None:
    model = loaded(FMU3)
    assert (model.name, model.origin, model.step) == ("Axes", "FMI 3.0 FMU", Fraction(1, 500))
    assert [(p.name, p.identifier, p.unit, p.type) for p in model.inputs] == [
        ("setpoint[1]", "setpoint_1", "rad", "real"),
        ("setpoint[2]", "setpoint_2", "rad", "real"),
        ("setpoint[3]", "setpoint_3", "rad", "real"),
        ("gain", "gain", "", "real"),
        ("mask", "mask", "", "integer"),
        ("hold", "hold", "", "boolean"),
    ]
    assert [(p.name, p.value) for p in model.parameters] == [("slope", 0.25), ("offset", -1.0)]
    assert {path.name for path in model.files} == {"modelDescription.xml", "all.c", "axes.c", "axes.h"}


def test_where_an_fmu_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "model"
    pack(FMU2, folder / "servo.fmu")
    assert loaded(folder).origin == loaded(folder / "servo.fmu").origin == "FMI 2.0 FMU"
    assert loaded(FMU2 / "modelDescription.xml").origin == "FMI 2.0 FMU"
    pack(FMU3, folder / "axes.fmu")
    id, message = only_error(folder)
    assert id == "model-ambiguous" and "2 models" in message
    assert only_error(FMU2 / "sources/servo.c")[0] == "model-not-recognised"


def test_a_matrix_has_its_elements_as_ports(tmp_path: Path) -> None:
    folder = changed(
        FMU3,
        tmp_path / "fmu",
        "modelDescription.xml",
        (
            'causality="output"><Dimension start="3"/>',
            'causality="output"><Dimension start="2"/><Dimension start="3"/>',
        ),
    )
    names = [port.name for port in loaded(folder).outputs]
    assert names[:6] == ["duty[1,1]", "duty[1,2]", "duty[1,3]", "duty[2,1]", "duty[2,2]", "duty[2,3]"]


def test_parameters_that_can_be_tuned_come_first(tmp_path: Path) -> None:
    fixed = ('variability="tunable"><Real start="2.0"/>', 'variability="fixed"><Real start="2.0"/>')
    model = loaded(changed(FMU2, tmp_path / "fmu", "modelDescription.xml", fixed))
    assert [(p.name, p.index, p.tunable) for p in model.parameters] == [
        ("PI.ki", 0, True),
        ("PI.kp", 1, False),
        ("table size", 2, False),
    ]
    assert [place.reference for place in model.code.parameters] == [4, 3, 2]  # type: ignore[union-attr]


def test_variables_that_are_only_read_may_share_a_value_reference(tmp_path: Path) -> None:
    """In FMI 2.0, they are aliases.  Each type has its own references."""
    local = 'name="integral" valueReference="5" causality="local"'
    for name, old, new in (
        ("output", local, 'name="integral" valueReference="2" causality="output"'),
        ("type", 'name="mode" valueReference="0"', 'name="mode" valueReference="3"'),  # that of a real parameter
    ):
        model, diagnostics = load(changed(FMU2, tmp_path / name, "modelDescription.xml", (old, new)))
        assert model is not None and list(diagnostics) == []


def test_a_parameter_without_a_start_value_keeps_that_of_the_code(tmp_path: Path) -> None:
    folder = changed(FMU2, tmp_path / "fmu", "modelDescription.xml", ('<Real start="2.0"/>', "<Real/>"))
    model, diagnostics = load(folder)
    assert model is not None and [p.name for p in model.parameters] == ["PI.ki", "table size"]
    assert [(item.severity, item.id) for item in diagnostics] == [("note", "fmu-no-parameter")]
    if HAVE_COMPILER:
        made, whole = (build(loaded(place), name, tmp_path) for place, name in ((folder, "pan"), (FMU2, "tilt")))
        assert run_wrapper(made, 30) == run_wrapper(whole, 30)


GENERAL = '<BuildConfiguration modelIdentifier="Axes">'
WINDOWS = '<BuildConfiguration modelIdentifier="Axes" platform="x86_64-windows">'
LINUX = '<BuildConfiguration modelIdentifier="Axes" platform="x86_64-linux">'


def test_a_build_configuration_for_a_platform_is_not_taken_silently(tmp_path: Path) -> None:
    """That of Linux is used before others; one for all platforms needs no warning, wherever it is."""
    build_file = "sources/buildDescription.xml"
    for number, (changes, warnings) in enumerate(
        [
            ([], []),
            ([(GENERAL, LINUX)], ["fmu-platform"]),
            ([(WINDOWS, WINDOWS.replace("Axes", "Arms")), (GENERAL, WINDOWS)], ["fmu-platform"]),
        ]
    ):
        model, diagnostics = load(changed(FMU3, tmp_path / str(number), build_file, *changes))
        assert model is not None and {path.name for path in model.files} >= {"all.c", "axes.c"}
        assert [item.id for item in diagnostics] == warnings


def test_one_instance_only(tmp_path: Path) -> None:
    flag = 'canBeInstantiatedOnlyOncePerProcess="true"'
    change = ('canHandleVariableCommunicationStepSize="true"', flag)
    assert not loaded(changed(FMU2, tmp_path / "fmu", "modelDescription.xml", change)).instantiable


@pytest.mark.parametrize(
    ("text", "id"),
    [
        ('void *p = fopen(self->name, "r");', "model-file-use"),
        ("self->law.errors = malloc(8);", "model-heap"),
        ("self->law.errors = self->functions->allocateMemory(1, 8);", "model-heap"),
    ],
)
def test_what_cannot_run_in_a_step(text: str, id: str, tmp_path: Path) -> None:
    change = ("    double error =", f"    {text}\n    double error =")
    path = changed(FMU2, tmp_path / "fmu", "sources/servo.c", change)
    found, _ = only_error(path)
    assert found == id
    _, diagnostics = load(pack(path, tmp_path / "a.fmu"))
    assert diagnostics.items[0].span.text is not None and text[:8] in diagnostics.items[0].span.text


def test_files_when_it_starts(tmp_path: Path) -> None:
    change = ("    self->functions = functions;", '    self->functions = functions; fopen("x", "r");')
    assert only_error(changed(FMU2, tmp_path / "fmu", "sources/servo.c", change))[0] == "model-file-use"


def test_sources_that_nobody_lists(tmp_path: Path) -> None:
    """For FMUs of older tools, every C file is a source."""
    folder = tmp_path / "fmu"
    text = (FMU2 / "modelDescription.xml").read_text()
    start, end = text.index("<SourceFiles>"), text.index("</SourceFiles>") + len("</SourceFiles>")
    changed(FMU2, folder, "modelDescription.xml", (text[start:end], ""))
    (folder / "sources/notes.txt").write_text("no source")
    assert {path.name for path in loaded(folder).files} == {"modelDescription.xml", "servo.c", "law.c", "law.h"}


@pytest.mark.parametrize("archive", [False, True], ids=["folder", "archive"])
def test_headers_in_folders_that_nothing_names(archive: bool, tmp_path: Path) -> None:
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("", ""))
    (folder / "sources" / "lib" / "control").mkdir(parents=True)
    (folder / "sources" / "law.h").rename(folder / "sources" / "lib" / "control" / "law.h")
    model, diagnostics = load(pack(folder, tmp_path / "a.fmu") if archive else folder)
    assert model is not None and isinstance(model.code, FmuExport)
    assert [(item.severity, item.id) for item in diagnostics] == [("note", "model-neighbour")]
    assert (
        "these headers are in 'sources/lib/control'" in diagnostics.items[0].message
        and "law.h" in diagnostics.items[0].message
    )
    if HAVE_COMPILER:
        run_wrapper(build(model, "servo", tmp_path / "build"), 3)


def test_headers_of_one_name_in_several_folders(tmp_path: Path) -> None:
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("", ""))
    for name in ("old", "new"):
        (folder / "sources" / name).mkdir()
        (folder / "sources" / name / "law.h").write_text((folder / "sources" / "law.h").read_text() + f"int {name};\n")
    (folder / "sources" / "law.h").unlink()
    id, message = only_error(folder)
    assert id == "fmu-file-missing" and "'law.h' is in 2 folders of the FMU" in message


def test_memory_that_steps_keep_is_one_error(tmp_path: Path) -> None:
    taking = "static void *one(void) { return malloc(1); }\nstatic void *two(void) { return malloc(2); }\n"
    text = ("    double error =", "    one(); two();\n    double error =")
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", text)
    source = folder / "sources" / "servo.c"
    source.write_text(source.read_text().replace("fmi2Status fmi2DoStep", f"{taking}fmi2Status fmi2DoStep", 1))
    id, message = only_error(folder)
    assert id == "model-heap" and "'one'" in message and "(also two)" in message


def test_headers_of_other_systems_may_be_missing(tmp_path: Path) -> None:
    other = '#ifdef _WIN32\n#include "windows_only.h"\n#endif\n#include "law.h"'
    loaded(changed(FMU2, tmp_path / "fmu", "sources/servo.c", ('#include "law.h"', other)))


# conditions, and files that are missing -------------------------------------------------------------------------------


def test_a_function_that_a_macro_hides(tmp_path: Path) -> None:
    """The FMU SDK compiles fmi2DoStep only with FMI_COSIMULATION: the hint names it, and with it the model is good."""
    source = FMU2 / "sources" / "servo.c"
    text = source.read_text()
    start = text.index("fmi2Status fmi2DoStep(")
    end = text.index("\n}\n", start) + 3
    hidden = f"#ifdef FMI_COSIMULATION\n{text[start:end]}#endif\n"
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", (text[start:end], hidden))
    model, diagnostics = load(folder)
    (problem,) = diagnostics
    assert model is None and problem.id == "fmu-not-compiled"
    assert problem.message == "fmi2DoStep is not compiled: the condition '#ifdef FMI_COSIMULATION' is false"
    assert "'definitions: {FMI_COSIMULATION: 1}'" in problem.hint
    description = folder / "modelDescription.xml"
    description.write_text(description.read_text().replace(' stepSize="1e-3"', ""))
    _, diagnostics = load(folder)
    (step,) = (item for item in diagnostics if item.id == "fmu-step")
    assert "'step: 1 ms' and 'definitions: {FMI_COSIMULATION: 1}'" in step.hint
    with_step = settings(tmp_path / "step", fmu="../fmu", step="1 ms")
    _, diagnostics = load(with_step)
    assert [item.hint for item in diagnostics] == ["write 'definitions: {FMI_COSIMULATION: 1}' in 'model.yaml'"]
    model = loaded(settings(tmp_path / "whole", fmu="../fmu", step="1 ms", definitions={"FMI_COSIMULATION": 1}))
    if HAVE_COMPILER:
        run_wrapper(build(model, "servo", tmp_path / "build"), 3)


@pytest.mark.parametrize(
    ("condition", "definitions"),
    [
        ("#ifdef WITH_FMI", "'definitions: {WITH_FMI: 1}'"),
        ("#if defined(ONE) && defined(TWO)", ""),
        ("#if 0\n#elif WITH_FMI", "'definitions: {WITH_FMI: 1}'"),
    ],
)
def test_the_condition_that_hides_a_function_is_around_it(condition: str, definitions: str, tmp_path: Path) -> None:
    """Conditions that end before the function, or that count only inside the false one, do not matter."""
    between = '#ifdef __cplusplus\nextern "C" {\n#endif\n#ifndef OTHER\n#  ifdef INNER\n'
    changes = [
        ("fmi2Status fmi2DoStep(", f"  {condition.replace('#elif', '  #elif')}\n{between}fmi2Status fmi2DoStep("),
        ("fmi2Status fmi2GetReal(", "#endif\n#endif\n#endif\nfmi2Status fmi2GetReal("),
    ]
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", *changes)
    description = folder / "modelDescription.xml"
    description.write_text(description.read_text().replace(' stepSize="1e-3"', ""))
    _, diagnostics = load(folder)
    hidden, step = sorted(diagnostics, key=lambda item: item.id)
    line = condition.split("\n")[-1]
    assert hidden.message == f"fmi2DoStep is not compiled: the condition '{line}' is false"
    place = hidden.span
    assert (folder / "sources/servo.c").read_text().split("\n")[place.line - 1][
        place.column - 1 : place.end - 1
    ] == line
    assert definitions in hidden.hint and definitions in step.hint
    assert definitions or ("the macros that make it true" in hidden.hint and "definitions" not in step.hint)


def test_a_function_for_windows_is_renamed_there_only(tmp_path: Path) -> None:
    """Otherwise a call of time() would be a call of a function that does not exist."""
    other = """#include <time.h>
#ifdef _WIN32
time_t time(time_t *t) { return 0; }
int only_there(void) { return 1; }
#elif defined(OTHER_SYSTEM)
int nowhere(void) { return 1; }
#endif
int everywhere(void) { return time(NULL) > 5; }
static double limit(double value)"""
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("static double limit(double value)", other))
    details = loaded(folder).code
    assert isinstance(details, FmuExport)
    assert details.conditional_renames == (("defined(_WIN32)", ("only_there", "time")),)
    assert "everywhere" in details.renames and not {"time", "nowhere", "only_there"} & set(details.renames)
    if HAVE_COMPILER:
        run_wrapper(build(loaded(folder), "servo", tmp_path / "build"), 3)


def test_a_function_of_the_library_under_a_condition_that_is_not_known_is_not_renamed(tmp_path: Path) -> None:
    """A macro of the system decides if the FMU's own strnlen() is compiled: else a call means the library's."""
    other = """#include <string.h>
#ifndef _POSIX_C_SOURCE
size_t strnlen(const char *text, size_t most) { return text[0] ? most : 0; }
int helper(void) { return 1; }
#endif
static double limit(double value)"""
    step = "    double error ="
    call = f"    if (strnlen(self->name, 1) > 1) return fmi2Error;\n{step}"
    folder = changed(
        FMU2, tmp_path / "fmu", "sources/servo.c", ("static double limit(double value)", other), (step, call)
    )
    details = loaded(folder).code
    assert isinstance(details, FmuExport)
    assert "strnlen" not in details.renames and "helper" in details.renames
    if HAVE_COMPILER:
        run_wrapper(build(loaded(folder), "servo", tmp_path / "build"), 3)


def test_parameters_of_old_functions_are_not_variables(tmp_path: Path) -> None:
    """Dymola's solvers were Fortran: with a parameter 'time', the FMU would lose the function time()."""
    old = """#include <time.h>
int solve_(n, tol,
    time)
int *n;
double tol, *time;
{
    return *n > tol && *time > 0;
}
static double limit(double value)"""
    step = "    double error ="
    call = "    double zero = 0;\n    (void)solve_(&self->integers[1], 0.0, &zero);\n"
    call += f"    if (time(NULL) < 0) return fmi2Error;\n{step}"
    folder = changed(
        FMU2, tmp_path / "fmu", "sources/servo.c", ("static double limit(double value)", old), (step, call)
    )
    details = loaded(folder).code
    assert isinstance(details, FmuExport)
    assert "solve_" in details.renames and not {"time", "tol", "n"} & set(details.renames)
    if HAVE_COMPILER:
        run_wrapper(build(loaded(folder), "servo", tmp_path / "build"), 3)


def test_variables_of_a_thread_are_ordinary_ones(tmp_path: Path) -> None:
    """Dymola has one such variable.  Otherwise no second start could restore it."""
    change = ("const int instances = 1;", "static __thread int steps;\nint instances(void) { return ++steps; }")
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", change)
    details = loaded(folder).code
    assert isinstance(details, FmuExport) and details.threads
    assert not loaded(FMU2).code.threads  # type: ignore[union-attr]
    if HAVE_COMPILER:
        run_wrapper(build(loaded(folder), "servo", tmp_path / "build"), 3)


def without_list(folder: Path) -> Path:
    description = folder / "modelDescription.xml"
    text = description.read_text()
    start, end = text.index("<SourceFiles>"), text.index("</SourceFiles>") + len("</SourceFiles>")
    description.write_text(text[:start] + text[end:])
    return folder


def test_a_file_that_another_one_includes_is_not_compiled_alone(tmp_path: Path) -> None:
    change = ("const int instances = 1;", '#include "part.c"\nconst int instances = 1;')
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", change)
    (folder / "sources" / "part.c").write_text("int is_stopped(servo_t *self) { return self->stopped; }\n")
    details = loaded(without_list(folder)).code
    assert isinstance(details, FmuExport)
    assert details.units == ("sources/law.c", "sources/servo.c")
    if HAVE_COMPILER:
        run_wrapper(build(loaded(folder), "servo", tmp_path / "build"), 3)


@pytest.mark.parametrize("archive", [False, True], ids=["folder", "archive"])
def test_sources_in_folders_are_found_as_a_linker_finds_them(archive: bool, tmp_path: Path) -> None:
    """OpenModelica lists no sources, and has those of its runtime in folders, with many that the FMU does not need."""
    folder = without_list(changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("", "")))
    below = folder / "sources" / "include" / "solver"
    below.mkdir(parents=True)
    (folder / "sources" / "law.c").rename(below / "law.c")
    (below / "law.c").write_text('#include "law.h"\n' + (below / "law.c").read_text())
    (below / "other.c").write_text("#include <no_such_header.h>\nint other(void) { return 1; }\n")
    path = pack(folder, tmp_path / "a.fmu") if archive else folder
    details = loaded(path).code
    assert isinstance(details, FmuExport)
    assert details.units == ("sources/servo.c", "sources/include/solver/law.c")
    if HAVE_COMPILER:
        run_wrapper(build(loaded(path), "servo", tmp_path / "build"), 3)


def test_files_are_parsed_once_while_others_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of 6 files needs the next one; the number of rounds in which files are found has a limit."""
    folder = without_list(changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("", "")))
    below = folder / "sources" / "below"
    below.mkdir()
    law = folder / "sources" / "law.c"
    law.write_text(f"int link0(void);\nint link(void);\nint link(void) {{ return link0(); }}\n{law.read_text()}")
    for n in range(6):
        call = f"int link{n + 1}(void);\nint link{n}(void) {{ return link{n + 1}(); }}\n"
        (below / f"{n}.c").write_text(call if n < 5 else "int link5(void) { return 5; }\n")
    parsed: list[str] = []

    def counted(file: SourceFile) -> CFile:
        parsed.append(file.path.name)
        return parse_code(file)

    monkeypatch.setattr("epg.generator.importers.fmu.fmu_reader.parse_code", counted)
    details = loaded(folder).code
    assert isinstance(details, FmuExport)
    assert details.units[2:] == tuple(f"sources/below/{n}.c" for n in range(6))
    assert max(parsed.count(name) for name in parsed) == 2  # each is looked into, or probed, and then read
    monkeypatch.setattr("epg.generator.importers.fmu.fmu_reader._MOST_ROUNDS", 3)
    details = loaded(folder).code
    assert isinstance(details, FmuExport)
    assert len(details.units) == 5


def test_a_source_that_is_missing(tmp_path: Path) -> None:
    """The linker would report it.  If the FMU has the file, but does not list it, the hint says so."""
    listed = ('      <File name="law.c"/>\n', "")
    folder = changed(FMU2, tmp_path / "fmu", "modelDescription.xml", listed)
    model, diagnostics = load(folder)
    (problem,) = diagnostics
    assert model is None and problem.id == "model-incomplete"
    assert problem.message == "'law_step' is called, but no source of the FMU defines it"
    assert problem.span.file.endswith("servo.c")
    assert problem.hint.startswith("'sources/law.c' defines it, but the FMU does not list it as a source")
    (folder / "sources" / "law.c").unlink()
    assert only_error(folder) == ("model-incomplete", problem.message)
    assert (
        only_error(without_list(changed(folder, tmp_path / "b", "modelDescription.xml", ("", ""))))[0]
        == "model-incomplete"
    )


def test_many_files_that_are_missing_are_one_error(tmp_path: Path) -> None:
    more = "".join(f'<File name="{name}.c"/>' for name in "abcdefg")
    folder = changed(FMU2, tmp_path / "fmu", "modelDescription.xml", ("<SourceFiles>", f"<SourceFiles>{more}"))
    assert only_error(folder) == (
        "fmu-file-missing",
        "'a.c' is listed as a source, but the FMU does not contain it (nor are 'b.c', 'c.c', 'd.c', 'e.c' and 2 more)",
    )
    includes = "#ifndef MINIMAL\n" + "".join(f'#include "{name}.h"\n' for name in "abc") + '#endif\n#include "law.h"'
    folder = changed(FMU2, tmp_path / "headers", "sources/servo.c", ('#include "law.h"', includes))
    _, diagnostics = load(folder)
    (problem,) = diagnostics
    assert problem.message == "'a.h' is not among the FMU's sources (nor are 'b.h', 'c.h')"
    assert "'definitions: {MINIMAL: 1}'" in problem.hint


def test_a_program_that_prints_often_has_one_warning(tmp_path: Path) -> None:
    """A stream that no code opens can be the terminal only."""
    change = (
        "    double error =",
        '    FILE *log = stderr; fprintf(log, "a"); fprintf(log, "b"); fflush(NULL);\n    double error =',
    )
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", change)
    model, diagnostics = load(folder)
    assert model is not None
    assert [item.id for item in diagnostics] == ["model-prints", "model-prints"]
    assert any("the model calls fprintf() in 2 places" in item.message for item in diagnostics)


def test_memory_that_the_caller_frees(tmp_path: Path) -> None:
    code = "static char *text_of(int n) { char *t = malloc(8); t[0] = (char)n; return t; }\n"
    call = ("    double error =", "    char *text = text_of(1); free(text);\n    double error =")
    folder = changed(
        FMU2, tmp_path / "fmu", "sources/servo.c", call, ("fmi2Status fmi2DoStep(", f"{code}fmi2Status fmi2DoStep(")
    )
    loaded(folder)
    kept = changed(folder, tmp_path / "kept", "sources/servo.c", (" free(text);", ""))
    assert only_error(kept)[0] == "model-heap"


# model.yaml ----------------------------------------------------------------------------------------------------------


def settings(folder: Path, **document: object) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "model.yaml").write_text(yaml.safe_dump({"version": 1, **document}))
    return folder


def test_model_yaml_says_what_the_fmu_does_not(tmp_path: Path) -> None:
    pack(FMU2, tmp_path / "model/servo.fmu")
    folder = settings(tmp_path / "model", fmu="servo.fmu", step="2 ms", heap="2 KiB", definitions={"A": 1, "B": None})
    model = loaded(folder)
    assert model.step == Fraction(1, 500) and model.code.heap == 2048  # type: ignore[union-attr]
    assert model.code.definitions == (("A", "1"), ("B", ""))  # type: ignore[union-attr]
    assert {path.name for path in model.files} == {"model.yaml", "servo.fmu"}
    assert model.directory == folder
    settings(tmp_path / "model", fmu=".")
    assert only_error(folder)[0] == "file-not-found"


WRONG = [
    ({"fmu": "a.fmu"}, "file-not-found"),
    ({"fmu": ""}, "wrong-value"),
    ({"fmu": ["servo.fmu"]}, "wrong-type"),
    ({"heap": 2048}, "wrong-type"),
    ({"heap": "2 kB"}, "wrong-value"),
    ({"heap": "1 B"}, "out-of-range"),
    ({"heap": "65 MiB"}, "out-of-range"),
    ({"step": "1"}, "wrong-unit"),
    ({"definitions": ["A"]}, "wrong-type"),
    ({"definitions": {"A B": 1}}, "invalid-name"),
    ({"definitions": {"A": [1]}}, "wrong-type"),
    ({"definitions": {"A": "1/* x"}}, "wrong-value"),
    ({"step": "0 s"}, "out-of-range"),
    ({"sources": ["a.c"]}, "unknown-key"),
    ({"version": 2}, "newer-version"),
]


@pytest.mark.parametrize(("change", "id"), WRONG, ids=[f"{next(iter(c))}-{n}" for n, (c, _) in enumerate(WRONG)])
def test_wrong_model_yaml(change: dict[str, object], id: str, tmp_path: Path) -> None:
    pack(FMU2, tmp_path / "model/servo.fmu")
    document = {"fmu": "servo.fmu", **change}
    assert only_error(settings(tmp_path / "model", **document))[0] == id


def test_the_step_must_suit_20sim(tmp_path: Path) -> None:
    """20-sim's FMUs take whole steps of their own length."""
    folder = changed(
        FMU2, tmp_path / "fmu", "modelDescription.xml", ('generationTool="tests"', 'generationTool="20-sim"')
    )
    assert loaded(folder).code.own_step == Fraction(1, 1000)  # type: ignore[union-attr]
    model = loaded(settings(tmp_path / "model", fmu="../fmu", step="3 ms"))
    assert (model.step, model.code.own_step) == (Fraction(3, 1000), Fraction(1, 1000))  # type: ignore[union-attr]
    assert only_error(settings(tmp_path / "model", fmu="../fmu", step="1.5 ms"))[0] == "fmu-step"


def test_the_step_of_20sims_method_is_read_from_the_sources(tmp_path: Path) -> None:
    """Independent of the description, and also if it does not name 20-sim."""
    for form in ("globals", "instance", "output time"):
        folder = Export(step="0.0005").write_whole_fmu(tmp_path / form, form)
        description = folder / "modelDescription.xml"
        text = description.read_text().replace('stepSize="0.0005"', 'stepSize="0.002"')
        description.write_text(text.replace(' generationTool="20-sim"', ""))
        model = loaded(folder)
        assert isinstance(model.code, FmuExport)
        assert (model.step, model.code.own_step) == (Fraction(2, 1000), Fraction(1, 2000))
        description.write_text(text.replace("0.002", "0.0007"))
        assert only_error(folder)[0] == "fmu-step"
        description.write_text(text.replace("0.002", "50.0005"))
        assert "more than 100000 internal steps of the FMU" in only_error(folder)[1]
    assert loaded(FMU2).code.own_step is None  # type: ignore[union-attr]


def test_the_identifier_of_the_sources(tmp_path: Path) -> None:
    """Only an identifier that the code uses counts; of several for different versions of FMI, one must fit."""
    define = '#define GUID "{6f1c9a0e-servo}"'
    other = '#define GUID "{another}"'
    for name, text, id in (
        ("other", other, "fmu-guid"),
        ("alias", '#define SERVO_GUID "{another}"\n#define GUID SERVO_GUID', "fmu-guid"),
        ("two", f'#if FMI_VERSION == 1\n#define GUID "{{old}}"\n#else\n{define}\n#endif', ""),
        ("unused", f'{define}\n#define TEMPLATE_GUID "{{none}}"', ""),
    ):
        folder = changed(FMU2, tmp_path / name, "sources/servo.c", (define, text))
        assert (only_error(folder)[0] if id else loaded(folder).name) == (id or 'Servo "1"')
    folder = Export().write_whole_fmu(tmp_path / "20sim", "instance")
    loaded(folder)
    (folder / "sources" / "fmiGUID.h").write_text('#define FMI_GUID "{of another export}"\n')
    packed = pack(folder, tmp_path / "packed.fmu")
    for path in (folder, packed):
        assert only_error(path)[0] == "fmu-guid"


# hostile archives ----------------------------------------------------------------------------------------------------

DESCRIPTION = (FMU2 / "modelDescription.xml").read_bytes()


def archive(*entries: tuple[str | zipfile.ZipInfo, bytes]) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as packed:
        for entry, content in entries:
            packed.writestr(entry, content)
    return data.getvalue()


def with_source(name: str | zipfile.ZipInfo, content: bytes = b"int x;") -> bytes:
    sources = [(f"sources/{path.name}", path.read_bytes()) for path in sorted((FMU2 / "sources").iterdir())]
    return archive(("modelDescription.xml", DESCRIPTION), *sources, (name, content))


def inside(folder: str, *more: tuple[str | zipfile.ZipInfo, bytes]) -> bytes:
    """The FMU in a folder of the archive."""
    files = [path for path in sorted(FMU2.rglob("*")) if path.is_file()]
    entries = [(f"{folder}/{path.relative_to(FMU2).as_posix()}", path.read_bytes()) for path in files]
    return archive(*entries, *more)


def link_to(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name)
    entry.create_system = 3
    entry.external_attr = 0o120777 << 16
    return entry


def edited(data: bytes, old: bytes, new: bytes) -> bytes:
    assert len(old) == len(new) and old in data
    return data.replace(old, new)


def encrypted(data: bytes) -> bytes:
    """The flag for encryption is set in every entry of the list of files."""
    at = data.find(b"PK\1\2")
    while at >= 0:
        data = data[: at + 8] + struct.pack("<H", struct.unpack_from("<H", data, at + 8)[0] | 1) + data[at + 10 :]
        at = data.find(b"PK\1\2", at + 4)
    return data


def bomb() -> bytes:
    return archive(
        ("modelDescription.xml", DESCRIPTION), *((f"sources/{n}.c", bytes(1) * (15 << 20)) for n in range(20))
    )


def lying_bomb() -> bytes:
    """The list of files claims that 40 MiB are 6 bytes."""
    data = archive(("modelDescription.xml", DESCRIPTION), ("sources/a.c", b"\n" * (40 << 20)))
    return data.replace(struct.pack("<L", 40 << 20), struct.pack("<L", 6))


def entity_bomb() -> bytes:
    levels = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 9))
    text = f'<!DOCTYPE x [<!ENTITY a0 "lol">{levels}]><fmiModelDescription fmiVersion="2.0">&a8;</fmiModelDescription>'
    return archive(("modelDescription.xml", text.encode()))


def external_entity() -> bytes:
    text = (
        '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><fmiModelDescription fmiVersion="2.0" modelName="&a;"/>'
    )
    return archive(("modelDescription.xml", text.encode()))


def huge_directory() -> bytes:
    return archive(*((f"r/{n}", b"") for n in range(20_001)))


def binary_source() -> bytes:
    """A listed source that is not text."""
    sources = {path.name: path.read_bytes() for path in (FMU2 / "sources").iterdir()}
    sources["law.c"] = b"\0\1\2"
    return archive(("modelDescription.xml", DESCRIPTION), *((f"sources/{name}", d) for name, d in sources.items()))


def packed_by(method: int, data: bytes = b"int x;\n" * 999) -> bytes:
    """An FMU with one source that is packed by another method than deflate."""
    output = io.BytesIO()
    with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("modelDescription.xml", DESCRIPTION)
        packed.writestr("sources/x.c", data, method)
    return output.getvalue()


def corrupt_lzma() -> bytes:
    data = packed_by(zipfile.ZIP_LZMA)
    at = data.find(b"sources/x.c") + len("sources/x.c")
    return data[: at + 4] + bytes(b ^ 0xFF for b in data[at + 4 : at + 30]) + data[at + 30 :]


def hidden_entries() -> bytes:
    """More entries than allowed, in an archive whose end record counts only one."""
    data = archive(*((f"r/{n}", b"") for n in range(20_001)))
    return data[:-14] + struct.pack("<2H", 1, 1) + data[-10:]


def claims_more() -> bytes:
    """The list of files claims that a stored file is 3 bytes longer than it is."""
    output = io.BytesIO()
    with zipfile.ZipFile(output, "w") as packed:
        packed.writestr("modelDescription.xml", DESCRIPTION)
        packed.writestr("sources/x.c", b"int x;\n" * 9)
    return output.getvalue().replace(struct.pack("<2L", 63, 63), struct.pack("<2L", 63, 66))


HOSTILE: dict[str, tuple[Callable[[], bytes], str]] = {
    "up": (lambda: with_source("sources/../../../evil.c"), "fmu-unreadable"),
    "up-hidden": (lambda: with_source("sources/a/../../evil.c"), "fmu-unreadable"),
    "backslash": (lambda: with_source("sources/..\\..\\evil.c"), "fmu-unreadable"),
    "drive": (lambda: with_source("sources/C:/evil.c"), "fmu-unreadable"),
    "empty-part": (lambda: with_source("sources//etc/evil.c"), "fmu-unreadable"),
    "list": (lambda: with_source("sources/a;b.c"), "fmu-unreadable"),
    "long": (lambda: with_source(f"sources/{'a' * 300}.c"), "fmu-unreadable"),
    "file-and-folder": (lambda: with_source("sources/law.h/x.h"), "fmu-unreadable"),
    "device": (lambda: with_source("sources/con.c"), "fmu-unreadable"),
    "control": (lambda: with_source("sources/a\x1b[2Jb.c"), "fmu-unreadable"),
    "nul": (lambda: edited(with_source("sources/evilXc.c"), b"evilXc", b"evil\0c"), "fmu-unreadable"),
    "trailing-dot": (lambda: with_source("sources/evil.c."), "fmu-unreadable"),
    "link": (lambda: with_source(link_to("sources/x.c"), b"/etc/passwd"), "fmu-unreadable"),
    "twice-by-case": (lambda: with_source("sources/LAW.c"), "fmu-unreadable"),
    "encrypted": (lambda: encrypted(with_source("sources/x.c")), "fmu-unreadable"),
    "bomb": (bomb, "fmu-unreadable"),
    "lying-bomb": (lying_bomb, "fmu-unreadable"),
    "entity-bomb": (entity_bomb, "model-xml"),
    "external-entity": (external_entity, "model-xml"),
    "many-files": (huge_directory, "fmu-unreadable"),
    "outer-lines": (lambda: inside("a\nflag\t-wrapper\nflag\tsh,-c,id\nx"), "fmu-unreadable"),
    "outer-up": (lambda: inside(".."), "fmu-unreadable"),
    "outer-root": (lambda: inside(""), "fmu-unreadable"),
    "outer-drive": (lambda: inside("C:"), "fmu-unreadable"),
    "outer-escape": (lambda: inside("a\x1b[2Jb"), "fmu-unreadable"),
    "no-zip": (lambda: b"MZ" * 1000, "fmu-unreadable"),
    "empty": (lambda: b"", "fmu-unreadable"),
    "truncated": (lambda: with_source("sources/x.c")[:-30], "fmu-unreadable"),
    "cut-content": (
        lambda: (data := with_source("sources/x.c"))[:60] + bytes(300) + data[360:],
        "fmu-unreadable",
    ),
    "binary-source": (binary_source, "model-unreadable"),
    "no-description": (lambda: archive(("sources/a.c", b"")), "fmu-unreadable"),
    "bzip2": (lambda: packed_by(zipfile.ZIP_BZIP2), "fmu-unreadable"),
    "bzip2-bomb": (lambda: packed_by(zipfile.ZIP_BZIP2, bytes(200 << 20)), "fmu-unreadable"),
    "lzma": (lambda: packed_by(zipfile.ZIP_LZMA), "fmu-unreadable"),
    "corrupt-lzma": (corrupt_lzma, "fmu-unreadable"),
    "hidden-entries": (hidden_entries, "fmu-unreadable"),
    "claims-more": (claims_more, "fmu-unreadable"),
    "method": (lambda: edited(with_source("sources/x.c"), b"\x08\x00", b"\x63\x00"), "fmu-unreadable"),
}


@pytest.mark.parametrize("kind", sorted(HOSTILE))
def test_hostile_archives(kind: str, tmp_path: Path) -> None:
    """One error each, in little time and memory, and no file is written."""
    make, id = HOSTILE[kind]
    folder = tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    path = folder / "servo.fmu"
    path.write_bytes(make())
    before = sorted(tmp_path.rglob("*"))
    tracemalloc.start()
    error, count = calls(lambda: only_error(path))
    assert error[0] == id and count < 1_500_000
    assert tracemalloc.get_traced_memory()[1] < 200 << 20
    tracemalloc.stop()
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("method", "name"), [(zipfile.ZIP_BZIP2, "bzip2"), (zipfile.ZIP_LZMA, "LZMA")], ids=["bzip2", "lzma"]
)
def test_other_methods_of_compression_are_named(method: int, name: str, tmp_path: Path) -> None:
    path = tmp_path / "servo.fmu"
    path.write_bytes(packed_by(method))
    assert only_error(path)[1] == f"'sources/x.c' in the FMU is compressed with {name}, which FMUs must not use"


@pytest.mark.parametrize("folder", [FMU2, FMU3], ids=["fmi2", "fmi3"])
def test_damage_of_any_kind(folder: Path, tmp_path: Path) -> None:
    """Changed bytes, in the archive or in its files, give a model or an error, never another exception."""
    random = Random(2)
    whole = pack(folder, tmp_path / "whole.fmu").read_bytes()
    names = [path.relative_to(folder).as_posix() for path in sorted(folder.rglob("*")) if path.is_file()]
    refused = 0
    for round in range(200):
        data = bytearray(whole)
        if round % 2:
            name = random.choice(["modelDescription.xml", *(n for n in names if n.endswith((".xml", ".c", ".h")))])
            text = bytearray((folder / name).read_bytes())
            for _ in range(random.randint(1, 4)):
                at = random.randrange(len(text))
                text[at : at + random.randint(0, 9)] = random.choice(
                    [b"", b"<", b'"', b"\0", b"9999999999", b"}", b"\xff"]
                )
            entries = [(n, bytes(text) if n == name else (folder / n).read_bytes()) for n in names]
            data = bytearray(archive(*entries))
        else:
            for _ in range(random.randint(1, 8)):
                data[random.randrange(len(data))] = random.randrange(256)
        path = tmp_path / "damaged.fmu"
        path.write_bytes(data)
        model, diagnostics = load(path)
        assert (model is None) == diagnostics.has_errors
        refused += model is None
    assert 50 < refused < 200


NAMES: dict[str, Callable[[str], str]] = {
    "backslashes": lambda name: name.replace("/", "\\"),
    "dots": lambda name: f"./{name}",
    "outer-folder": lambda name: f"servo 1/{name}",
    "outer-folder-of-a-mac": lambda name: f"servo/{name}",
    "all": lambda name: f"./servo/{name}".replace("/", "\\"),
}


@pytest.mark.parametrize("kind", NAMES)
def test_names_as_some_tools_write_them(kind: str, tmp_path: Path) -> None:
    entries = []
    for path in sorted(FMU2.rglob("*")):
        if path.is_file():
            entry = zipfile.ZipInfo("x")
            entry.filename = NAMES[kind](path.relative_to(FMU2).as_posix())
            entries.append((entry, path.read_bytes()))
    if kind == "outer-folder-of-a-mac":
        entries.append((zipfile.ZipInfo("__MACOSX/servo/._modelDescription.xml"), b"x"))
    path = tmp_path / "servo.fmu"
    path.write_bytes(archive(*entries))
    model = loaded(path)
    assert [port.name for port in model.inputs] == [port.name for port in loaded(FMU2).inputs]
    if HAVE_COMPILER and kind == "all":
        run_wrapper(build(model, "servo", tmp_path / "build"), 3)
    twice = tmp_path / "twice.fmu"
    twice.write_bytes(archive(*entries, (NAMES[kind]("sources/LAW.c"), b"int x;")))
    assert only_error(twice)[0] == "fmu-unreadable"
    out = tmp_path / "out.fmu"
    out.write_bytes(archive(*entries, (NAMES[kind]("sources/../../evil.c"), b"int x;")))
    assert only_error(out)[0] == "fmu-unreadable"


@pytest.mark.parametrize("name", [".DS_Store", "desktop.ini", "Thumbs.db", "._servo"])
def test_files_of_a_file_manager_beside_the_outer_folder(name: str, tmp_path: Path) -> None:
    path = tmp_path / "servo.fmu"
    path.write_bytes(inside("servo 1", (name, b"x")))
    loaded(path)


def test_what_is_no_part_of_the_model_does_not_matter(tmp_path: Path) -> None:
    """EPG unpacks no other file, whatever its name is."""
    path = tmp_path / "servo.fmu"
    path.write_bytes(with_source("resources/../../evil?.txt"))
    loaded(path)
