# SPDX-License-Identifier: Apache-2.0
"""The library of a model: its results, and several libraries in one program.

Results must be equal, bit for bit, to those of the export's own code through its own interface.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from pathlib import Path

import pytest

from epg.generator.emit.model import emit_model, model_build
from tests.doubles.twenty_sim.exports import Export
from tests.models.direct import run_c_vectors, run_cpp_class
from tests.models.harness import (
    MODELS,
    Library,
    build,
    compile_file,
    load,
    loaded,
    run,
    run_program,
    run_wrapper,
    values,
)
from tests.twenty_sim.generate import write_by_template

STEPS = 400


def direct_c(folder: Path, export: Export, work: Path) -> str:
    sources = [path for path in sorted(folder.glob("*.c")) if path.name != "xxmain.c"]
    counts = (len(export.inputs), len(export.outputs))
    prefixes = (export.variable, export.function)
    return run_c_vectors(sources, [folder], work, counts, STEPS, export.suffix, prefixes)


@pytest.mark.parametrize(
    "export",
    [
        Export(),
        Export(version="4.5.1.5561", method="Euler", newline="\r\n"),
        Export(method="RungeKutta2"),
        Export(variable="Pan_", function="Pan"),
        Export(variable="yy_", function="YY", suffix="tilt"),
        Export(encoding="latin-1", user="Jérôme"),
        Export(dynamic='\tif (time > 0.2) { XXStopSimulation ("late", 0); }\n'),
    ],
    ids=["discrete", "euler-4.5-crlf", "rk2", "renamed", "suffix", "latin-1", "stops"],
)
def test_c_function_gives_its_own_numbers(export: Export, tmp_path: Path) -> None:
    folder = export.write(tmp_path / "model")
    assert run_wrapper(build(loaded_quietly(folder), "pan", tmp_path), STEPS) == direct_c(folder, export, tmp_path)


def loaded_quietly(folder: Path):  # type: ignore[no-untyped-def]
    (folder / "tokens.xml").unlink(missing_ok=True)
    return loaded(folder)


@pytest.mark.parametrize("method", ["Discrete", "Euler"])
def test_cpp_class_gives_its_own_numbers(method: str, tmp_path: Path) -> None:
    folder = Export(method=method).write_cpp(tmp_path / "model")
    expected = run_cpp_class(folder, "Servo", tmp_path, (2, 2), STEPS)
    assert run_wrapper(build(loaded(folder), "pan", tmp_path), STEPS) == expected


@pytest.mark.parametrize("method", ["Discrete", "Euler", "RungeKutta2"])
def test_tokens_alone_give_the_numbers_of_the_sources(method: str, tmp_path: Path) -> None:
    export = Export(method=method)
    expected = direct_c(export.write(tmp_path / "c"), export, tmp_path)
    assert run_wrapper(build(loaded(export.write_tokens(tmp_path / "t")), "pan", tmp_path), STEPS) == expected


def test_runge_kutta_4_from_tokens_is_of_fourth_order(tmp_path: Path) -> None:
    """Halving the step divides the error of x' = -x by 16, compared with the exact solution."""
    zero = {"DYNAMIC_EQUATIONS": "\txx_R[0] = -xx_s[0];\n\txx_R[1] = xx_V[4] * 0.0;\n\txx_V[1] = xx_s[0];\n"}
    zero |= {"OUTPUT_EQUATIONS": "", "INITIALIZE_STATES": "\txx_s[0] = 1.0;\n\txx_s[1] = 0.0;\n"}
    errors = []
    for version in ("4.5.1.5561", "5.1.4.13773"):
        for step, count in (("0.2", 10), ("0.1", 20)):
            export = Export(method="RungeKutta4", step=step, version=version, token_values=zero)
            folder = export.write_tokens(tmp_path / version / step)
            rows = values(run_wrapper(build(loaded(folder), "rk", folder), count))
            errors.append(abs(rows[count][1] - math.exp(-2.0)))
    assert 13 < errors[0] / errors[1] < 18
    assert 13 < errors[2] / errors[3] < 18


@pytest.mark.parametrize("describe", ["tokens.xml", "ModelConfiguration.xml", "modelDescription.xml"])
@pytest.mark.parametrize("instance", [False, True], ids=["4.5", "4.6"])
def test_sources_of_an_fmu_give_the_numbers_of_the_c_function(instance: bool, describe: str, tmp_path: Path) -> None:
    export = Export(method="Euler", parameters=(("PI1\\kp", "1.25", ""), *Export().parameters[1:]))
    expected = direct_c(export.write(tmp_path / "c"), export, tmp_path)
    model = loaded(export.write_fmu(tmp_path / "fmu", instance, describe).parent)
    assert [port.name for port in (*model.inputs, *model.outputs)] == ["in", "position", "corr", "out"]
    assert model.instantiable == instance
    assert run_wrapper(build(model, "pan", tmp_path), STEPS) == expected
    changed = build(model, "other", tmp_path, {"PI1\\kp": 2.5})
    assert run_wrapper(changed, 10) == run_wrapper(
        build(loaded(Export(method="Euler").write(tmp_path / "d")), "x", tmp_path), 10
    )


KINDS: dict[str, Callable[[Export, Path], Path]] = {
    "c": Export.write,
    "c++": Export.write_cpp,
    "tokens": Export.write_tokens,
    "template": write_by_template,
}


@pytest.fixture(params=sorted(KINDS))
def servo(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """The same controller in every form."""
    return KINDS[request.param](Export(), tmp_path / "model")


RUN = """
#include "{name}.h"
#include <stdio.h>
static {name}_inputs_t in = {{0.5, 0.1}};
static {name}_outputs_t out;
static void run({name}_t *self, int steps)
{{
    {name}_init(self, &in, &out);
    printf("%.17g %.17g\\n", out.corr, out.out);
    for (int k = 0; k < steps; k++) {{
        {name}_step(self, &in, &out);
        printf("%.17g %.17g\\n", out.corr, out.out);
    }}
}}
int main(void)
{{
    {name}_t *self = {name}_instance(0);
    {body}
    return 0;
}}
"""


def program(library: Library, body: str, folder: Path, options: tuple[str, ...] = ()) -> list[list[str]]:
    text = RUN.format(name=library.name, body=body)
    return [line.split() for line in run_program(folder, text, [library], options).splitlines()]


def test_starting_again_is_starting_afresh(servo: Path, tmp_path: Path) -> None:
    library = build(loaded(servo), "pan", tmp_path)
    rows = program(library, "run(self, 50); pan_set_parameter(self, PAN_PI1_KP, 9.0); run(self, 50);", tmp_path)
    assert len(rows) == 102 and rows[:51] == rows[51:]
    assert rows[0] != rows[50]


def test_one_call_is_one_step_and_time_starts_at_zero(servo: Path, tmp_path: Path) -> None:
    library = build(loaded(servo), "pan", tmp_path)
    rows = program(library, "run(self, 3);", tmp_path)
    # corr is 10 kp + time
    assert [float(row[0]) for row in rows] == pytest.approx([25.0, 25.001, 25.002, 25.003], abs=1e-12)


def test_parameters_act_as_if_exported_with_them(servo: Path, tmp_path: Path) -> None:
    model = loaded(servo)
    changed = tuple(
        (name, {"PI1\\kp": "0.7", "Limiter\\maximum": "0.3"}.get(name, v), u) for name, v, u in Export().parameters
    )
    kind = {"20-sim C function": "c", "20-sim C++ class": "c++", "20-sim tokens": "tokens"}[model.origin]
    exported = loaded(KINDS[kind](Export(parameters=changed), tmp_path / "exported"))
    overridden = build(model, "pan", tmp_path / "a", {"PI1\\kp": 0.7, "Limiter\\maximum": 0.3})
    expected = build(exported, "pan", tmp_path / "b")
    plain = build(model, "pan", tmp_path / "c")
    assert run_wrapper(overridden, 100) == run_wrapper(expected, 100) != run_wrapper(plain, 100)


def test_setting_a_parameter_recomputes_what_depends_on_it(servo: Path, tmp_path: Path) -> None:
    library = build(loaded(servo), "pan", tmp_path)
    body = """
    run(self, 1);
    pan_set_parameter(self, PAN_PI1_KP, 0.05);
    pan_step(self, &in, &out);
    double kp = pan_get_parameter(self, PAN_PI1_KP);
    printf("%.17g %.17g %.17g\\n", out.out, kp, pan_get_parameter(self, PAN_FILTER_TAU));
    """
    out, kp, tau = map(float, program(library, body, tmp_path)[-1])
    assert (kp, tau) == (0.05, 0.05)
    assert 2 * 0.05 * 0.4 <= out < 0.1  # 2 kp (in - position), plus a small part from the states


def test_a_model_that_stops_is_seen(tmp_path: Path) -> None:
    for kind, write in sorted(KINDS.items()):
        stop = '\tif (time > 0.0105) { XXStopSimulation ("enough", 0); }\n'
        folder = write(Export(dynamic=stop), tmp_path / kind / "model")
        library = build(loaded(folder), "pan", tmp_path / kind)
        body = """
        run(self, 10);
        printf("%d\\n", pan_stopped(self));
        pan_step(self, &in, &out);
        printf("%d\\n", pan_stopped(self));
        double before = out.corr;
        pan_step(self, &in, &out);
        printf("%d\\n", out.corr >= before);
        pan_init(self, &in, &out);
        printf("%d\\n", pan_stopped(self));
        """
        assert [row[0] for row in program(library, body, tmp_path / kind)[-4:]] == ["0", "1", "1", "0"], kind


def test_the_end_of_the_experiment_ends_nothing(servo: Path, tmp_path: Path) -> None:
    """The experiment ends after 2 s, which are 2000 steps."""
    rows = program(build(loaded(servo), "pan", tmp_path), "run(self, 2100);", tmp_path)
    times = [float(row[0]) - 25.0 for row in rows]
    assert times[2100] == pytest.approx(2.1, abs=1e-9) and times[2100] > times[2099]


@pytest.mark.parametrize("options", [(), ("-O2", "-ffast-math")], ids=["plain", "fast-math"])
def test_values_that_are_not_finite_are_found(servo: Path, options: tuple[str, ...], tmp_path: Path) -> None:
    library = build(loaded(servo), "pan", tmp_path, options=options)
    body = """
    run(self, 3);
    printf("%d\\n", pan_finite(self));
    union { unsigned long long bits; double value; } nan = {0x7FF8000000000000u};
    in.position = nan.value;
    pan_step(self, &in, &out);
    printf("%d\\n", pan_finite(self));
    in.position = 0.1;
    pan_step(self, &in, &out);
    printf("%d\\n", pan_finite(self));
    pan_init(self, &in, &out);
    printf("%d\\n", pan_finite(self));
    """
    flags = [row[0] for row in program(library, body, tmp_path, options) if len(row) == 1]
    assert flags[0] == "1" and flags[-1] == "1" and "0" in flags[1:3]


def test_there_is_no_instance_beyond_the_last(servo: Path, tmp_path: Path) -> None:
    library = build(loaded(servo), "pan", tmp_path)
    body = 'printf("%d %d %u\\n", self != 0, pan_instance(1) == 0 && pan_instance(~0u) == 0, PAN_INSTANCES);'
    assert program(library, body, tmp_path) == [["1", "1", "1"]]


TWO = """
#include "a.h"
#include "b.h"
#include <stdio.h>
int main(void)
{
    static a_inputs_t ia = {0.5, 0.1};
    static b_inputs_t ib = {-0.3, 0.2};
    a_outputs_t oa;
    b_outputs_t ob;
    a_t *a = a_instance(0);
    b_t *b = b_instance(0);
    a_init(a, &ia, &oa);
    b_init(b, &ib, &ob);
    for (int k = 0; k < 40; k++) {
        a_step(a, &ia, &oa);
        b_step(b, &ib, &ob);
        if (k == 20) {
            b_set_parameter(b, B_PI1_KP, 0.5);
            ib.in += 0.1;
        }
    }
    printf("%.17g %.17g\\n%.17g %.17g\\n", oa.corr, oa.out, ob.corr, ob.out);
    return 0;
}
"""


@pytest.mark.parametrize(
    ("first", "second"), [("c", "c"), ("c++", "c++"), ("c", "c++"), ("tokens", "c"), ("tokens", "tokens")]
)
def test_two_models_in_one_program(first: str, second: str, tmp_path: Path) -> None:
    """The same unrenamed export twice, and exports of different kinds, do not disturb each other."""
    a = loaded(KINDS[first](Export(), tmp_path / "model_a"))
    b = loaded(KINDS[second](Export(name="Tilt", method="Euler"), tmp_path / "model_b"))
    both = run_program(tmp_path / "both", TWO, [build(a, "a", tmp_path / "1"), build(b, "b", tmp_path / "1")])
    alone_a = run_program(
        tmp_path / "aa", TWO, [build(a, "a", tmp_path / "2"), build(loaded_dummy(tmp_path), "b", tmp_path / "2")]
    )
    alone_b = run_program(
        tmp_path / "bb", TWO, [build(loaded_dummy(tmp_path), "a", tmp_path / "3"), build(b, "b", tmp_path / "3")]
    )
    assert both.splitlines() == [alone_a.splitlines()[0], alone_b.splitlines()[1]]
    assert both.splitlines()[0] != both.splitlines()[1]


def loaded_dummy(folder: Path):  # type: ignore[no-untyped-def]
    """A model of another kind that shares no code with the two."""
    return loaded(
        Export(name="Dummy", variable="dd_", function="DD", suffix="dummy", tokens=False).write(folder / "dummy")
    )


INSTANCES = """
#include "pan.h"
#include <stdio.h>
int main(void)
{
    static pan_inputs_t in[3] = {{0.5, 0.1}, {-0.3, 0.2}, {0.5, 0.1}};
    pan_outputs_t out[3];
    for (unsigned i = 0; i < PAN_INSTANCES; i++) {
        pan_init(pan_instance(i), &in[i], &out[i]);
    }
    pan_set_parameter(pan_instance(1), PAN_PI1_KP, 1.0);
    for (int k = 0; k < 30; k++) {
        for (unsigned i = 0; i < PAN_INSTANCES; i++) {
            pan_step(pan_instance(i), &in[i], &out[i]);
        }
    }
    for (unsigned i = 0; i < PAN_INSTANCES; i++) {
        printf("%.17g %.17g\\n", out[i].corr, out[i].out);
    }
    return pan_instance(PAN_INSTANCES) != 0;
}
"""


@pytest.mark.parametrize("kind", ["c++", "tokens", "template"])
def test_instances_are_independent(kind: str, tmp_path: Path) -> None:
    model = loaded(KINDS[kind](Export(), tmp_path / "model"))
    rows = run_program(tmp_path / "run", INSTANCES, [build(model, "pan", tmp_path, instances=3)]).splitlines()
    alone = program(build(model, "pan", tmp_path / "alone"), "run(self, 30);", tmp_path / "alone")[-1]
    assert rows[0].split() == rows[2].split() == alone
    assert rows[1] != rows[0]


def test_a_c_export_has_one_instance(tmp_path: Path) -> None:
    model = loaded(Export().write(tmp_path))
    assert not model.instantiable
    with pytest.raises(ValueError, match="2 instances"):
        emit_model(model, "pan", {}, 2)


def test_unknown_parameter_is_a_bug_of_the_caller(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no parameter"):
        emit_model(loaded(Export().write(tmp_path)), "pan", {"PI1\\kd": 1.0})


# hand-written -------------------------------------------------------------------------------------------------------

PID = """
#include "pid.h"
#include <stdio.h>
int main(void)
{
    static pid_inputs_t in = {1.0, 0.25, 1.0, 3.0};
    pid_outputs_t out;
    for (unsigned i = 0; i < PID_INSTANCES; i++) {
        pid_t *pid = pid_instance(i);
        pid_init(pid, &in, &out);
        printf("%.17g %.17g %.17g\\n", out.duty, out.steps, out.saturated);
        for (int k = 0; k < 20; k++) {
            pid_step(pid, &in, &out);
        }
        printf("%.17g %.17g %.17g %d %d\\n", out.duty, out.steps, out.saturated, pid_stopped(pid), pid_finite(pid));
        pid_init(pid, &in, &out);
        printf("%.17g %.17g\\n", out.duty, out.steps);
        pid_set_parameter(pid, PID_KP, 4.0 + i);
        pid_step(pid, &in, &out);
        printf("%.17g %.17g\\n", out.duty, pid_get_parameter(pid, PID_INTEGRAL_RATE));
    }
    return 0;
}
"""


@pytest.mark.parametrize("rate", [0.125, 0.5])
def test_hand_written_model_with_instances(rate: float, tmp_path: Path) -> None:
    # the library's name differs from the user's own symbols, which would otherwise collide
    library = build(loaded(MODELS / "pid_c"), "loop", tmp_path, {"integral rate": rate}, instances=2)
    text = re.sub(
        r"\bpid_(?=[a-z_]+\(|inputs_t|outputs_t|t\b)",
        "loop_",
        PID.replace("PID_", "LOOP_").replace('"pid.h"', '"loop.h"'),
    )
    rows = [[float(word) for word in line.split()] for line in run_program(tmp_path, text, [library]).splitlines()]
    for i, block in enumerate((rows[:4], rows[4:])):
        assert block[0] == [1.5, 0, 0]
        total = rate * 0.75 * 20
        assert block[1] == [min(1.5 + total, 3.0), 20, 1.0 if 1.5 + total >= 3.0 else 0.0, 0, 1]
        assert block[2] == [1.5, 0]
        assert block[3] == [min((4.0 + i) * 0.75 + rate * 0.75, 3.0), rate]


def test_an_integer_of_a_hand_written_model_stays_in_its_range(tmp_path: Path) -> None:
    """In C, converting a double outside the range of an int is undefined behaviour."""
    text = """
#include "loop.h"
#include <math.h>
#include <stdio.h>
int main(void)
{
    const double limits[] = {1e300, -1e300, NAN, 2147483647.5, -3.7};
    for (int i = 0; i < 5; i++) {
        loop_inputs_t in = {4e9, 0.0, 1.0, limits[i]};
        loop_outputs_t out;
        loop_init(loop_instance(0), &in, &out);
        printf("%.17g ", out.duty);
    }
    return 0;
}
"""
    sanitize = ["-fsanitize=float-cast-overflow", "-fno-sanitize-recover=all"]
    library = build(loaded(MODELS / "pid_c"), "loop", tmp_path, options=sanitize)
    found = run_program(tmp_path, text, [library], sanitize).split()
    assert found == ["2147483647", "-2147483648", "0", "2147483647", "-4"]  # with NaN, the model is not started


def test_a_library_called_like_the_code_it_wraps(tmp_path: Path) -> None:
    """The user's header, types and functions have the names of the generated ones; a class has that of its library."""
    pid = build(loaded(MODELS / "pid_c"), "pid", tmp_path, instances=2)
    assert run_program(tmp_path, PID, [pid]).split()[0] == "1.5"
    for kind, write in sorted(KINDS.items()):
        folder = write(Export(), tmp_path / kind)
        values_ = {"PI1\\kp": 0.5}
        expected = run_wrapper(build(loaded(folder), "other", tmp_path / kind, values_), 20)
        assert run_wrapper(build(loaded(folder), "Servo", tmp_path / kind, values_), 20) == expected
        assert run_wrapper(build(loaded(folder), "xxmodel", tmp_path / kind, values_), 20) == expected


def test_hand_written_cpp_model(tmp_path: Path) -> None:
    text = """
#include "f.h"
#include <stdio.h>
int main(void)
{
    f_inputs_t in = {4.0};
    f_outputs_t out;
    f_init(f_instance(1), &in, &out);
    printf("%.17g\\n", out.filtered);
    in.level = 8.0;
    f_step(f_instance(1), &in, &out);
    printf("%.17g %.17g\\n", out.filtered, f_get_parameter(f_instance(1), F_GAIN));
    return 0;
}
"""
    library = build(loaded(MODELS / "pid_cpp"), "f", tmp_path, instances=2)
    assert run_program(tmp_path, text, [library]).split() == ["4", repr(math.sqrt(4.25)), "0.25"]


def test_hand_written_model_with_globals_beside_another(tmp_path: Path) -> None:
    """Both define a global variable `shared`."""
    text = """
#include "g.h"
#include "loop.h"
#include <stdio.h>
int main(void)
{
    g_inputs_t in = {1.5, 2.0};
    g_outputs_t out;
    g_init(g_instance(0), &in, &out);
    printf("%g %g ", out.scaled, out.first);
    g_step(g_instance(0), &in, &out);
    printf("%g %g %d", out.scaled, out.first, loop_instance(0) != 0);
    return 0;
}
"""
    libraries = [
        build(loaded(MODELS / "gain_arrays"), "g", tmp_path),
        build(loaded(MODELS / "pid_c"), "loop", tmp_path),
    ]
    assert run_program(tmp_path, text, libraries) == "0 0 6 1.5 1"


# text ---------------------------------------------------------------------------------------------------------------


def test_text_of_the_export_cannot_break_out(tmp_path: Path) -> None:
    """Names that end comments, continue lines or contain trigraphs give a valid header with the same meaning."""
    tokens = Export(token_values={}).write_tokens(tmp_path / "model")
    path = tokens / "tokens.xml"
    text = path.read_text()
    names = [("in", "in ??/"), ("position", "pos\\"), ("PI1\\kp", 'k"p\\'), ("Servo", "Se*rvo */ /* ??/")]
    for old, new in names:
        text = text.replace(f"\n{old}\n", f"\n{new}\n").replace(f"CDATA[{old}\n", f"CDATA[{new}\n")
        text = text.replace(f"/* {old} {{", f"/* {new} {{").replace(f"CDATA[{old}]", f"CDATA[{new}]")
    path.write_text(text)
    library = build(loaded(path), "pan", tmp_path)
    for standard in ("c", "c++"):
        main = tmp_path / "main.c"
        main.write_text('#include "pan.h"\nint main(void) { return sizeof(pan_inputs_t) != 2 * sizeof(double); }\n')
        flags = [f"-I{library.folder}", "-Wall", "-Wextra", "-Wcomment", "-Wtrigraphs", "-trigraphs", "-Werror"]
        compile_file(main, tmp_path / "main.o", [*flags, *(["-x", "c++"] if standard == "c++" else [])], standard)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_generated_text_depends_on_the_export_alone(kind: str, tmp_path: Path) -> None:
    first = emit_model(loaded(KINDS[kind](Export(), tmp_path / "here" / "model")), "pan", {"PI1\\kp": 1.0})
    second = emit_model(
        loaded(KINDS[kind](Export(), tmp_path / "there" / "long" / "way" / "model")), "pan", {"PI1\\kp": 1.0}
    )
    assert first == second
    assert not any(str(tmp_path) in text for text in first.values())


def test_header_tells_what_the_model_is(tmp_path: Path) -> None:
    header = emit_model(loaded(Export().write(tmp_path)), "pan")["pan.h"]
    assert "double position; /**< position {rad} */" in header
    assert "#define PAN_STEP_SIZE 0.001" in header
    assert "PAN_PI1_TAUI, /**< PI1\\tauI {s} = 0.8 */" in header
    assert "5.1.4.13773" in header


def test_parameters_that_differ_in_case_only(tmp_path: Path) -> None:
    parameters = (
        ("Kp", "1.0", ""),
        ("KP", "2.0", ""),
        ("step_size", "3.0", ""),
        ("a\\b", "4.0", ""),
        ("a.b", "5.0", ""),
    )
    model = loaded(Export(parameters=parameters).write(tmp_path / "model"))
    library = build(model, "pan", tmp_path)
    names = ("PAN_Kp", "PAN_KP", "PAN_STEP_SIZE_", "PAN_A_B", "PAN_A_B_2")
    body = "run(self, 0);" + "".join(f'printf("%g\\n", pan_get_parameter(self, {name}));' for name in names)
    assert [row[0] for row in program(library, body, tmp_path)[1:]] == ["1", "2", "3", "4", "5"]


def test_a_model_without_inputs_and_parameters(tmp_path: Path) -> None:
    folder = Export(inputs=(), tokens=False).write(tmp_path / "model")
    for name in ("xxmodel.c",):
        text = (folder / name).read_text()
        text = re.sub(r"(?<!XXDouble )xx_P\[\d\]", "1.0", re.sub(r"\txx_P\[\d\] = [^\n]*\n", "", text))
        (folder / name).write_text(text)
    model = loaded(folder)
    assert model.parameters == () and model.inputs == ()
    rows = values(run_wrapper(build(model, "pan", tmp_path), 3))
    assert len(rows) == 5


def test_headers_in_another_case_are_found(tmp_path: Path) -> None:
    rename = {"xxfuncs.h": "XXFuncs.h", "motionprofiles.h": "MotionProfiles.H"}
    folder = Export(rename=rename, tokens=False).write(tmp_path / "model")
    expected = run_wrapper(build(loaded(Export(tokens=False).write(tmp_path / "plain")), "pan", tmp_path / "1"), 50)
    assert run_wrapper(build(loaded(folder), "pan", tmp_path / "2"), 50) == expected


def test_single_precision_export(tmp_path: Path) -> None:
    model, _ = load(Export(real="float", tokens=False).write(tmp_path / "model"))
    assert model is not None
    rows = values(run_wrapper(build(model, "pan", tmp_path), 100))
    double = values(run_wrapper(build(loaded(Export(tokens=False).write(tmp_path / "d")), "pan", tmp_path / "d2"), 100))
    assert rows[100] != double[100] and rows[100] == pytest.approx(double[100], rel=1e-4)


@pytest.mark.parametrize("kind", ["c", "c++"])
def test_single_precision_export_limits_numbers(kind: str, tmp_path: Path) -> None:
    """1e39 is not infinity, and NaN is not a number that the model gets."""
    model, _ = load(KINDS[kind](Export(real="float", tokens=False), tmp_path / "model"))
    assert model is not None
    body = """
    run(self, 1);
    in.{first} = -1e39;
    {name}_step(self, &in, &out);
    printf("%d %lu\\n", {name}_finite(self), {name}_clamped(self));
    {name}_set_parameter(self, 0, 1e39);
    printf("%.9g %lu\\n", {name}_get_parameter(self, 0), {name}_clamped(self));
    run(self, 1);
    in.{first} = not_a_number;
    {name}_step(self, &in, &out);
    printf("%.17g %.17g\\n", out.corr, out.out);
    printf("%d\\n", {name}_finite(self));
    in.{first} = 0.5;
    {name}_step(self, &in, &out);
    printf("%d\\n", {name}_finite(self));
    {name}_set_parameter(self, 0, not_a_number);
    {name}_step(self, &in, &out);
    printf("%d\\n", {name}_finite(self));
    run(self, 1);
    printf("%d %lu\\n", {name}_finite(self), {name}_clamped(self));
"""
    body = body.replace("{first}", model.inputs[0].identifier).replace("{name}", "pan")
    text = RUN.format(name="pan", body=body)
    text = "#include <math.h>\nstatic const double not_a_number = (double)NAN;\n" + text
    library = build(model, "pan", tmp_path)
    found = [line.split() for line in run_program(tmp_path, text, [library]).splitlines()]
    assert found[2][1] == "1" and found[3] == ["3.40282347e+38", "2"]
    assert found[6] == found[5]  # the step with NaN was not taken
    assert found[7:10] == [["0"], ["1"], ["0"]] and found[-1] == ["1", "4"]
    assert found[-3:-1] == found[:2]


def test_export_is_not_touched(tmp_path: Path) -> None:
    folder = Export().write(tmp_path / "model")
    before = {path: path.read_bytes() for path in folder.rglob("*")}
    build(loaded(folder), "pan", tmp_path, {"PI1\\kp": 1.0})
    assert {path: path.read_bytes() for path in folder.rglob("*")} == before


def test_build_lists_what_to_compile(tmp_path: Path) -> None:
    model = loaded(Export().write(tmp_path))
    made = model_build(model, "pan")
    assert made.generated == ("pan.c",) and made.exported_generated == ("pan_export.c",)
    assert [path.name for path in made.exported] == ["xxsubmod.c", "xxfuncs.c", "xxinteg.c", "xxmodel.c"]
    assert made.forced_header == "pan_names.h" and made.language == "c"
    changed = model_build(model, "pan", {"PI1\\kp": 1.0})
    assert changed.exported_generated == ("pan_export.c", "pan_copies/xxmodel.c")
    assert [path.name for path in changed.exported] == ["xxsubmod.c", "xxfuncs.c", "xxinteg.c"]
    names = set(emit_model(model, "pan", {"PI1\\kp": 1.0}))
    assert names == {"pan.h", "pan.c", "pan_export.h", "pan_export.c", "pan_names.h", "pan_copies/xxmodel.c"}


SANITIZE = ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")


def test_no_undefined_behaviour(servo: Path, tmp_path: Path) -> None:
    library = build(loaded(servo), "pan", tmp_path, {"PI1\\kp": 0.5}, options=SANITIZE)
    assert len(program(library, "run(self, 100); run(self, 100);", tmp_path, SANITIZE)) == 202


def test_nothing_is_allocated_after_the_start(tmp_path: Path) -> None:
    """A C++ export allocates in its constructor; it must not allocate in a step or when it starts again."""
    library = build(loaded(Export().write_cpp(tmp_path / "model")), "pan", tmp_path)
    counter = tmp_path / "count.cpp"
    counter.write_text(
        '#include <cstdlib>\n#include <new>\nextern "C" { int allocations; }\n'
        "void *operator new[](std::size_t n) { allocations++; return std::malloc(n); }\n"
        "void *operator new(std::size_t n) { allocations++; return std::malloc(n); }\n"
        "void operator delete[](void *p) noexcept { std::free(p); }\n"
        "void operator delete(void *p) noexcept { std::free(p); }\n"
        "void operator delete[](void *p, std::size_t) noexcept { std::free(p); }\n"
        "void operator delete(void *p, std::size_t) noexcept { std::free(p); }\n"
    )
    made = Library(
        "pan", library.folder, (*library.objects, compile_file(counter, tmp_path / "count.o", [], "c++")), library.model
    )
    text = RUN.format(
        name="pan", body='run(self, 1); int n = allocations; run(self, 20); printf("%d %d\\n", n > 0, allocations - n);'
    )
    rows = run_program(tmp_path, "extern int allocations;\n" + text, [made]).splitlines()
    assert rows[-1] == "1 0"


def test_symbols_begin_with_the_name(tmp_path: Path) -> None:
    """The linker sees only the library's own names."""
    for kind, write in sorted(KINDS.items()):
        library = build(loaded(write(Export(), tmp_path / kind / "model")), "pan", tmp_path / kind)
        for made in library.objects:
            for line in run(["nm", "-g", "--defined-only", str(made)]).splitlines():
                symbol = line.split()[-1]
                assert symbol.startswith(("pan_", "_Z", "DW.ref", "epg_variables_")) or not symbol, (kind, symbol)
                assert not re.search("Servo|Submodel|XX", symbol) or symbol.startswith("pan_private_"), (kind, symbol)
