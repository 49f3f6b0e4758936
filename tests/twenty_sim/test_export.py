# SPDX-License-Identifier: Apache-2.0
"""EPG's target for 20-sim: its export gives the same bits as the C export of the same model."""

from __future__ import annotations

import re
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from epg.cli.main import main
from tests.doubles.twenty_sim.exports import Export
from tests.models.direct import run_c_vectors, run_cpp_class
from tests.models.harness import HAVE_COMPILER, build, load, loaded, run_wrapper, values
from tests.twenty_sim.direct import close, compile_export, difference, run_export, run_program
from tests.twenty_sim.generate import FOLDER, PERSONAL, ROOT, generate, generate_from, targets, tokens_of

STEPS = 400
METHODS = ("Discrete", "Euler", "RungeKutta2", "RungeKutta4")
JIWY = ROOT / "examples/jiwy/model"
RELBOT = ROOT / "examples/relbot/model"
COUNTS = (2, 2)  # inputs and outputs of the tests' small model

pytestmark = pytest.mark.skipif(not HAVE_COMPILER, reason="gcc and g++ are not installed: sudo apt install gcc g++")


def c_function(export: Export, work: Path) -> str:
    """The results of the small model's C function.  It has no Runge Kutta 4; EPG's own from tokens replaces it."""
    if export.method == "RungeKutta4":
        return run_wrapper(build(loaded(export.write_tokens(work / "tokens")), "tokens", work), STEPS)
    folder = replace(export, tokens=False).write(work / "c_function")
    sources = [folder / name for name in ("xxsubmod.c", "xxmodel.c", "xxinteg.c", "xxfuncs.c")]
    return run_c_vectors(sources, [folder], work / "direct", COUNTS, STEPS)


@pytest.mark.parametrize("method", METHODS)
def test_numbers_of_the_c_function(method: str, tmp_path: Path) -> None:
    export = Export(method=method)
    folder = generate(tokens_of(export), tmp_path / "model")
    expected = c_function(export, tmp_path)
    assert not difference(run_export(folder, "Servo", tmp_path / "alone", COUNTS, STEPS), expected)
    assert not difference(run_wrapper(build(loaded(folder), "pan", tmp_path), STEPS), expected)
    assert len(set(expected.splitlines())) > STEPS / 2  # it moves


def test_numbers_of_the_examples(tmp_path: Path) -> None:
    jiwy = generate_from(JIWY / "tokens.xml", tmp_path / "jiwy")
    expected = run_c_vectors(sorted(JIWY.glob("*.c")), [JIWY], tmp_path / "c", (4, 6), STEPS)
    assert not difference(run_export(jiwy, "JIWY_Control", tmp_path / "jiwy_alone", (4, 6), STEPS), expected)
    assert not difference(run_wrapper(build(loaded(jiwy), "jiwy", tmp_path / "epg"), STEPS), expected)
    relbot = generate_from(RELBOT / "RELbot_Control_tokens.xml", tmp_path / "relbot")
    model = loaded(relbot)
    counts = (len(model.inputs), len(model.outputs))
    found = run_export(relbot, "RELbot_Control", tmp_path / "relbot_alone", counts, STEPS)
    tokens = build(loaded(RELBOT / "RELbot_Control_tokens.xml"), "tokens", tmp_path)
    assert not difference(found, run_wrapper(tokens, STEPS))
    # this class adds the slopes of Runge Kutta 4 in another order than 20-sim's templates since 4.6
    expected = run_cpp_class(RELBOT, "RELbot_Control", tmp_path / "cpp", counts, STEPS)
    assert close(found, expected, 1e-9)


def test_epg_reads_all_that_20_sim_knows(tmp_path: Path) -> None:
    """The same ports, units, parameters and method as from the C export, and also types and descriptions."""
    ours, theirs = loaded(generate_from(JIWY / "tokens.xml", tmp_path / "model")), loaded(JIWY)
    for group in ("inputs", "outputs", "parameters"):
        assert [(p.name, p.unit, p.index) for p in getattr(ours, group)] == [
            (p.name, p.unit, p.index) for p in getattr(theirs, group)
        ]
    assert [p.value for p in ours.parameters] == [p.value for p in theirs.parameters]
    assert (ours.name, ours.version, ours.method, ours.step) == (
        theirs.name,
        theirs.version,
        theirs.method,
        theirs.step,
    )
    assert ours.instantiable


PAIR = """
#include "Servo.h"
#include <stdio.h>
static Servo_ModelInstance models[2];
static void start(int i, double gain)
{
    double u[2] = {0.0, 0.0}, y[2];
    Servo_ModelInitialize(&models[i]);
    models[i].P[0] = gain;
    Servo_InitializeSubmodel(&models[i], u, y, 0.0);
}
static void step(int i, int k)
{
    double u[2] = {0.001 * (k % 700), 0.0004 * (k % 300)}, y[2];
    Servo_CalculateSubmodel(&models[i], u, y);
    if (k % 10 == 0) { printf("%d %a %a\\n", i, y[0], y[1]); }
}
int main(void)
{
    BODY
    return 0;
}
"""


def test_two_instances_at_once_with_different_parameters(tmp_path: Path) -> None:
    folder = generate(tokens_of(Export(method="RungeKutta4")), tmp_path / "model")

    def rows(body: str, name: str) -> list[str]:
        return run_program(PAIR.replace("BODY", body), folder, "Servo", tmp_path / name).splitlines()

    both = rows("start(0, 2.5); start(1, 0.3); for (int k = 0; k < 900; k++) { step(0, k); step(1, 899 - k); }", "both")
    first = rows("start(0, 2.5); for (int k = 0; k < 900; k++) { step(0, k); }", "first")
    second = rows("start(1, 0.3); for (int k = 0; k < 900; k++) { step(1, 899 - k); }", "second")
    assert [row for row in both if row[0] == "0"] == first
    assert [row for row in both if row[0] == "1"] == second
    assert len(first) == len(second) == 90


def test_a_changed_parameter_acts_on_what_is_derived_from_it(tmp_path: Path) -> None:
    folder = generate(tokens_of(Export()), tmp_path / "model")
    body = "start(0, 2.5); models[0].P[0] = {}; {} step(0, 350);"
    static = "Servo_CalculateStatic(&models[0]);"
    unchanged, not_yet, changed = (
        run_program(PAIR.replace("BODY", body.format(*given)), folder, "Servo", tmp_path / str(i))
        for i, given in enumerate([("2.5", static), ("0.3", ""), ("0.3", static)])
    )
    assert unchanged == not_yet != changed


@pytest.mark.parametrize("method", METHODS)
def test_single_precision_is_near(method: str, tmp_path: Path) -> None:
    tokens = tokens_of(Export(method=method))
    single = generate(tokens, tmp_path / "single", "EPGSinglePrecision")
    double = generate(tokens, tmp_path / "double")
    near = values(run_export(single, "Servo", tmp_path / "near", COUNTS, 300))
    exact = values(run_export(double, "Servo", tmp_path / "exact", COUNTS, 300))
    largest = max(abs(value) for row in exact for value in row)
    worst = max(abs(a - b) for one, other in zip(near, exact, strict=True) for a, b in zip(one, other, strict=True))
    assert 0 < worst < 1e-4 * largest  # 24 bits, 300 steps
    assert "typedef float Servo_real;" in (single / "Servo.h").read_text()
    assert loaded(single).code.real == "float"  # type: ignore[attr-defined]
    assert len(run_wrapper(build(loaded(single), "pan", tmp_path), 20).splitlines()) == 22


def test_nothing_is_kept_outside_of_the_instance(tmp_path: Path) -> None:
    folder = generate_from(JIWY / "tokens.xml", tmp_path / "model")
    symbols = subprocess.run(
        ["nm", str(compile_export(folder, "JIWY_Control", tmp_path))], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    kinds = {line.split()[-2] for line in symbols}
    assert not kinds & set("BbCGgSs"), symbols
    writable = [line for line in symbols if line.split()[-2] in "Dd" and not line.endswith("_names")]
    assert writable == []  # tables of names need relocation: constant data
    taken = [line.split()[-1] for line in symbols if line.split()[-2] in "TDR"]
    assert all(name.startswith("JIWY_Control_") for name in taken)


CONFIGURATION = """<modelConfiguration>
\t<general>
\t\t<name>Servo</name>
\t\t<creationDate>2015-10-30T12:29:29.0Z of Doe</creationDate>
\t\t<modelDir>C:\\Users\\jane.doe\\My Models\\</modelDir>
\t\t<originalModel>C:\\Users\\jane.doe\\My Models\\Servo.emx</originalModel>
\t\t<additional>Jane Doe,
 20-sim 4.7 Professional Single</additional>
\t\t<creator><name>20-sim</name></creator>
\t</general>
\t<modelVariables>
\t\t<modelVariable><name>in</name><kind>input</kind><type>real</type>
\t\t<description>where to go</description></modelVariable>
\t\t<modelVariable><name>position</name><kind>input</kind><type>integer</type></modelVariable>
\t\t<modelVariable><name>corr</name><kind>output</kind><type>real</type></modelVariable>
\t\t<modelVariable><name>out</name><kind>output</kind><type>boolean</type></modelVariable>
\t</modelVariables>
</modelConfiguration>"""


def test_no_personal_data_in_any_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Names, paths and licences with every special character: no file has them after ``epg exported``."""
    folder = tmp_path / "My Exports & more" / "Servo (1) 100%"
    generate(tokens_of(Export()), folder, configuration=CONFIGURATION)
    assert main(["exported", str(folder)]) == 0
    printed = capsys.readouterr()
    assert printed.err == ""  # no warning: the metadata agree with the sources
    assert "position" in printed.out and f'--model "{folder}"' in printed.out
    texts = {path.name: path.read_text(encoding="utf-8").lower() for path in folder.iterdir()}
    assert len(texts) == 6
    for name, text in texts.items():
        for word in ("doe", "users", "professional", "campus", *(value.lower() for value in PERSONAL.values())):
            assert word not in text, f"{word} in {name}"
    model = loaded(folder)
    assert [(p.name, p.type, p.unit, p.description) for p in model.inputs] == [
        ("in", "real", "rad", "where to go"),
        ("position", "integer", "rad", ""),
    ]
    assert [p.type for p in model.outputs] == ["real", "boolean"]
    before = (folder / "ModelConfiguration.xml").read_bytes()
    assert main(["exported", "--json", str(folder)]) == 0
    assert capsys.readouterr().out.startswith("{")
    assert (folder / "ModelConfiguration.xml").read_bytes() == before


def test_templates_use_no_token_about_people() -> None:
    known = {*tokens_of(Export()), *(name for target in targets().values() for name in target.tokens)}
    known |= {"MODEL_CONFIGURATION", "NUMBER_MATRICES", "NUMBER_IMPORTS", "NUMBER_EXPORTS", "NUMBER_UNNAMED"}
    known |= {"NUMBEROF_DELAYFUNCTION", "NUMBEROF_INITIALFUNCTION"}
    known |= {"XXSIM_SCRIPT_MODE", "USERPROFILE"}  # variables of Windows' environment, which 20-sim leaves alone
    for path in sorted(FOLDER.iterdir()):
        used = set(re.findall(r"%([A-Z0-9_]+)%", path.read_text() + path.name))
        used |= set(re.findall(r"[(,]([A-Z]+_[A-Z_]+)", "".join(re.findall(r"%IF%%[A-Z]+\(.*", path.read_text()))))
        used -= {"IF", "ELSE", "ENDIF"}
        assert not used & PERSONAL.keys(), path.name
        assert used <= known, path.name


@pytest.mark.parametrize(
    ("token", "id"),
    [
        ("NUMBER_DEPSTATES", "model-dependent-states"),
        ("NUMBER_ALGLOOPS", "model-algebraic-loop"),
        ("NUMBER_CONSTRAINTS", "model-constraint"),
    ],
)
def test_what_needs_a_solver_is_refused(token: str, id: str, tmp_path: Path) -> None:
    folder = generate({**tokens_of(Export()), token: "1"}, tmp_path)
    model, diagnostics = load(folder)
    assert model is None
    assert id in {item.id for item in diagnostics}


@pytest.mark.parametrize("token", ["NUMBER_MATRICES", "NUMBER_IMPORTS", "NUMBER_EXPORTS", "NUMBER_DEPSTATES"])
def test_what_the_target_does_not_export_does_not_compile(token: str, tmp_path: Path) -> None:
    folder = generate({**tokens_of(Export()), token: "1"}, tmp_path / "model")
    with pytest.raises(AssertionError, match=r"#error This (?:sub)?model "):
        compile_export(folder, "Servo", tmp_path)


def test_a_method_without_a_fixed_step_is_refused(tmp_path: Path) -> None:
    model, diagnostics = load(generate(tokens_of(Export(method="BDF")), tmp_path))
    assert model is None
    assert {item.id for item in diagnostics if item.severity == "error"} == {"model-variable-step"}


LANGUAGE = {
    "XXAbsolute (-2.5)": 2.5,
    "XXSign (-3.0) + XXSign (0.0)": -1.0,
    "XXRound (2.5) + XXRound (-2.5) + XXRound (0.4)": 0.0,
    "XXIntegerDivide (7.0, 2.0) + XXIntegerModulo (7.0, 4.0)": 6.0,
    "XXExponent2 (3.0)": 8.0,
    "XXExponent10 (2.0)": 100.0,
    "XXLogarithm10 (1000.0)": 3.0,
    "XXLogarithm2 (8.0)": 3.0,
    "XXPow2 (3.0) + XXPower (2.0, 3.0)": 17.0,
    "XXRamp (1.0, 3.0) + XXStep (1.0, 3.0)": 3.0,
    "XXImpulse (0.0, 0.5, 0.2, 0.1) + XXImpulse (0.0, 0.5, 0.7, 0.1)": 2.0,
    "XXXor (1.0, 0.0) + XXXor (1.0, 2.0)": 1.0,
    "XXBitAnd (12, 10) + XXBitOr (12, 10) + XXBitXor (12, 10)": 28.0,
    "XXBitGet (4, 3) + XXBitSet (0, 3) + XXBitClear (7, 1) + XXBitInv (0)": 10.0,
    "XXBitShift (1, 4) + XXBitShift (16, -4) + XXBitShiftRight (16, 2) + XXBitCmp (5, 3)": 23.0,
    "XXSwapBytes (16777216)": 1.0,
    "XXArcSineHyperbolic (0.0) + XXArcCosineHyperbolic (1.0) + XXArcTangentHyperbolic (0.0)": 0.0,
    'XXString2Double ("C:\\\\new\\\\table.txt")': 0.0,
    "(XXRandom (3.0) < 3.0) && (XXRandom (3.0) > -3.0)": 1.0,
}


def test_functions_of_the_equation_language(tmp_path: Path) -> None:
    """Each function of SIDOPS+ that C lacks, and the memory of delay() and initial()."""
    tokens = tokens_of(Export(outputs=(("a", ""),), inputs=(("in", ""),)))
    results = "".join(f"\txx_V[{8 + i}] = {text};\n" for i, text in enumerate(LANGUAGE))
    count = 8 + len(LANGUAGE)
    tokens |= {
        "DYNAMIC_EQUATIONS": "\txx_V[6] = XXDelay (xx_time, -1.0, 0);\n\txx_V[7] = XXInitialValue (xx_time + 5.0, 0);\n"
        '\tXXWarning ("far", 1);\n\tif (xx_time > 0.0025) { XXStopSimulation ("far", 2); }\n' + results,
        "OUTPUT_EQUATIONS": "\txx_V[0] = xx_V[6];\n",
        "NUMBER_VARIABLES": str(count),
        "NUMBEROF_DELAYFUNCTION": "1",
        "NUMBEROF_INITIALFUNCTION": "1",
    }
    folder = generate(tokens, tmp_path / "model")
    text = """
#include "Servo.h"
#include <stdio.h>
int main(void)
{
    static Servo_ModelInstance m;
    double u[1], y[1];
    Servo_ClearInputs(u);
    Servo_ClearOutputs(y);
    Servo_ModelInitialize(&m);
    Servo_InitializeSubmodel(&m, u, y, 0.0);
    for (int k = 0; k < 4; k++) {
        printf("%.9g %.9g %d\\n", y[0], m.V[7], m.stop_simulation);
        Servo_CalculateSubmodel(&m, u, y);
    }
    for (int i = 8; i < (int)(sizeof m.V / sizeof m.V[0]); i++) { printf("%.12g\\n", m.V[i]); }
    for (int i = 0; Servo_parameter_names[i]; i++) { puts(Servo_parameter_names[i]); }
    return 0;
}
"""
    lines = run_program(text, folder, "Servo", tmp_path / "run").splitlines()
    assert lines[:4] == ["-1 5 0", "0 5 0", "0.001 5 0", "0.002 5 1"]
    assert [float(line) for line in lines[4 : 4 + len(LANGUAGE)]] == pytest.approx(list(LANGUAGE.values()), abs=1e-9)
    assert lines[4 + len(LANGUAGE) :] == ["PI1\\kp", "PI1\\tauI", "Filter\\tau", "Limiter\\maximum"]


def test_a_model_without_inputs_states_and_parameters(tmp_path: Path) -> None:
    tokens = tokens_of(Export(inputs=(), parameters=(), method="Euler"))
    empty = {name: "" for name in tokens if name.endswith(("_EQUATIONS", "_STATES", "_PARAMETERS", "_VALUES"))}
    zero = {f"NUMBER_{name}": "0" for name in ("INPUTS", "STATES", "PARAMETERS", "INITIAL_VALUES")}
    ports = {name: tokens[name] for name in ("VARIABLE_TO_OUTPUT_EQUATIONS", "INITIALIZE_OUTPUTS")}
    tokens |= empty | zero | ports | {"OUTPUT_EQUATIONS": "\txx_V[0] = xx_time;\n"}
    folder = generate(tokens, tmp_path / "model")
    rows = values(run_wrapper(build(loaded(folder), "pan", tmp_path), 3))
    assert [row[0] for row in rows[:4]] == pytest.approx([0.0, 0.001, 0.002, 0.003])


def test_the_command_file(tmp_path: Path) -> None:
    """20-sim does not change it: it has no token, so that no path can break it."""
    folder = generate(tokens_of(Export()), tmp_path)
    text = (folder / "open_in_epg.cmd").read_bytes()
    assert text == (FOLDER / "open_in_epg.cmd").read_bytes()
    assert text.count(b"\r\n") == text.count(b"\n")
    assert b'"epg_folder=%~dp0."' in text  # with the dot: a backslash before the quote would escape it


def test_targets_ini() -> None:
    found = targets()
    assert [target.value("targetName") for target in found.values()] == [
        "Embedded-Project Generator",
        "Embedded-Project Generator (single precision)",
    ]
    for target in found.values():
        assert target.value("templateDirectory") == FOLDER.name
        assert {*target.files, "Targets.ini"} == {path.name for path in FOLDER.iterdir()}
        assert target.value("postCommand") in target.files
        assert target.value("integrationMethods").split(";") == list(METHODS)


def test_the_command_line_tells_where_the_folder_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--20-sim-dir"]) == 0
    assert Path(capsys.readouterr().out.strip()) == FOLDER
