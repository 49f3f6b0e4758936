# SPDX-License-Identifier: Apache-2.0
"""The library of an FMU gives the same bits as the standard's functions, and uses memory of fixed size."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from epg.generator.emit.model import emit_model, model_build
from epg.generator.importers.fmu.fmu_export import FmuExport
from tests.models.fmus import FMU2, FMU3, changed, pack, run_fmu2, run_fmu3
from tests.models.harness import INCLUDE, Library, build, loaded, run, run_program, run_wrapper, sources_of_variables

STEPS = 300
RUN = {FMU2: run_fmu2, FMU3: run_fmu3}


@pytest.mark.parametrize("folder", [FMU2, FMU3], ids=["fmi2", "fmi3"])
def test_gives_its_own_numbers(folder: Path, tmp_path: Path) -> None:
    """Tested from the folder and from the archive."""
    # the last line is after the end: EPG sets the inputs once more, which these FMUs ignore then
    expected = RUN[folder](tmp_path / "direct", STEPS)
    assert len(set(expected.splitlines())) > STEPS / 2
    sanitize = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    library = build(loaded(folder), "pan", tmp_path, options=sanitize)
    assert run_wrapper(library, STEPS, options=sanitize) == expected
    archive = pack(folder, tmp_path / "packed.fmu", {"binaries/win64/x.dll": b"MZ", "resources/a.txt": b"?"})
    assert run_wrapper(build(loaded(archive), "tilt", tmp_path), STEPS) == expected


@pytest.mark.parametrize("folder", [FMU2, FMU3], ids=["fmi2", "fmi3"])
def test_every_step_has_the_same_size(folder: Path, tmp_path: Path) -> None:
    """FMUs compare the size of a step, and count with it.  The time is a multiple of it, not a sum."""
    if folder == FMU2:
        file, size, count = "sources/servo.c", 0.001, "self->integers[1]"
        old = "self->integers[1] = (int)((currentCommunicationPoint + communicationStepSize) * 1000.0 + 0.5);"
    else:
        file, size, count = "sources/axes.c", 0.002, "self->count"
        old = "self->count += 1;"
    new = f"""
    if (communicationStepSize != {size} || currentCommunicationPoint != (double){count} * {size}) {{
        return fmi{2 if folder == FMU2 else 3}Error;
    }}
    {count} += (int)(communicationStepSize / {size});"""
    library = build(loaded(changed(folder, tmp_path / "fmu", file, (old, new))), "pan", tmp_path)
    output = "steps" if folder == FMU2 else "count"
    body = f"""
    pan_init(a, &in, &out);
    for (int k = 0; k < 1000; k++) {{ pan_step(a, &in, &out); }}
    printf("%d %g\\n", pan_finite(a), out.{output});
"""
    assert program(body, [library], tmp_path / "run") == [[1, 1000]]


def test_every_number_but_zero_is_true(tmp_path: Path) -> None:
    """The output is the setpoint as soon as the servo is enabled."""
    body = """
    const double values[] = {0.0, -0.0, 1.0, 0.5, 0.25, 1e-300, -1.0, 2.0};
    in.plant_setpoint = 0.5;
    for (unsigned i = 0; i < sizeof values / sizeof values[0]; i++) {
        in.enable = values[i];
        pan_init(a, &in, &out);
        printf("%g ", out.duty);
    }
"""
    rows = program(body, [build(loaded(FMU2), "pan", tmp_path)], tmp_path / "run")
    assert rows == [[0, 0, *[0.5] * 6]]


def test_numbers_that_the_type_of_a_port_cannot_hold(tmp_path: Path) -> None:
    """They are rounded to the nearest and limited; NaN is not a number of these types, so no step is taken with it."""
    end = "    return fmi2OK;\n}\n\nfmi2Status fmi2GetReal"
    change = (end, f"    self->integers[1] = self->integers[0];\n{end}")
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", change)
    body = """
    const double values[] = {0.5, 2.5, -2.5, 0.49999999999999994, -1.2, 1e10, -1e10, 2147483647.4};
    pan_init(a, &in, &out);
    for (unsigned i = 0; i < sizeof values / sizeof values[0]; i++) {
        in.mode = values[i];
        pan_step(a, &in, &out);
        printf("%.0f ", out.steps);
    }
    printf("%lu ", pan_clamped(a));
    in.mode = 7.0;
    pan_step(a, &in, &out);
    in.mode = NAN;
    pan_step(a, &in, &out);
    printf("%d %.0f ", pan_finite(a), out.steps);
    in.mode = 3.0;
    in.enable = NAN;
    pan_init(a, &in, &out);
    printf("%d ", pan_finite(a));
    in.enable = 1.0;
    pan_init(a, &in, &out);
    printf("%d\\n", pan_finite(a));
"""
    rows = program(body, [build(loaded(folder), "pan", tmp_path)], tmp_path / "run")
    assert rows == [[1, 3, -3, 0, -1, 2147483647, -2147483648, 2147483647, 2, 0, 7, 0, 1]]


@pytest.mark.parametrize("sign", [1, -1])
def test_an_output_of_64_bits_is_a_whole_number_that_a_double_has(sign: int, tmp_path: Path) -> None:
    change = ("self->count += 1;", f"self->count = {sign} * (1ll << 60);")
    body = """
    in.mask = 1.0;
    in.gain = 1.0;
    axes_init(a, &in, &out);
    axes_step(a, &in, &out);
    printf("%.17g %lu\\n", out.count, axes_clamped(a));
"""
    folder = changed(FMU3, tmp_path / "fmu", "sources/axes.c", change)
    assert program(body, [build(loaded(folder), "axes", tmp_path)], tmp_path / "run") == [[sign * 2.0**53, 1]]


def test_a_float_is_never_infinite(tmp_path: Path) -> None:
    """The first output is setpoint times gain: the largest float, not infinity."""
    body = """
    in.setpoint_1 = 1.0;
    in.mask = 1.0;
    in.gain = 1e39;
    axes_init(a, &in, &out);
    printf("%d %.17g ", axes_finite(a), out.duty_1 + 1.0);
    in.gain = NAN;
    axes_step(a, &in, &out);
    printf("%d\\n", axes_finite(a));
"""
    rows = program(body, [build(loaded(FMU3), "axes", tmp_path)], tmp_path / "run")
    assert rows == [[1, float.fromhex("0x1.fffffep127"), 0]]


def test_a_prefix_that_is_put_together(tmp_path: Path) -> None:
    """The prefix is composed from the model identifier, in macros, by sources that require it."""
    parts = """#define MODEL_IDENTIFIER Servo
#define paste(a, b) a##b
#define paste_values(a, b) paste(a, b)
#define FMI2_FUNCTION_PREFIX paste_values(MODEL_IDENTIFIER, _)"""
    change = ("#define FMI2_FUNCTION_PREFIX Servo_", parts)
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", change)
    library = build(loaded(folder), "pan", tmp_path)
    assert run_wrapper(library, 30) == run_fmu2(tmp_path / "direct", 30)


def test_functions_of_its_own_that_are_named_like_the_standards(tmp_path: Path) -> None:
    """Two FMUs with such a function can be in one program."""
    more = "int fmi2DoStepInternal(int steps)\n{\n    return steps + 1;\n}\n\nfmi2Component fmi2Instantiate("
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("fmi2Component fmi2Instantiate(", more))
    libraries = [build(loaded(folder), name, tmp_path) for name in ("pan", "tilt")]
    text = '#include "pan.h"\n#include "tilt.h"\nint main(void) { return !pan_instance(0) || !tilt_instance(0); }\n'
    run_program(tmp_path / "run", text, libraries)


def test_arrays_with_a_size_of_their_own_and_text(tmp_path: Path) -> None:
    """A structural parameter keeps its start value, a state may be an array, and only numbers are read and set."""
    size, text = '<Dimension start="3"/>', '<String name="label" valueReference="21" causality="input"/>'
    text += '<Binary name="trace" valueReference="22" causality="output"/>'
    text += '<Clock name="tick" valueReference="23" causality="output" intervalVariability="triggered"/>'
    text += '<UInt64 name="axes" valueReference="20" causality="structuralParameter" variability="fixed" start="3"/>'
    folder = changed(
        FMU3,
        tmp_path / "fmu",
        "modelDescription.xml",
        (size, '<Dimension valueReference="20"/>'),
        ('<Float64 name="time"', f'{text}<Float64 name="time"'),
        ('derivative="11"', 'derivative="1"'),  # as if the setpoints were states
    )
    model = loaded(folder)
    assert [port.name for port in model.inputs] == [p.name for p in loaded(FMU3).inputs]
    assert isinstance(model.code, FmuExport)
    assert (model.code.states, model.code.state_count) == ((1,), 3)
    assert run_wrapper(build(model, "pan", tmp_path), 30) == run_fmu3(tmp_path / "direct", 30)


def test_enumerations_get_no_value_beyond_their_items(tmp_path: Path) -> None:
    """This FMU refuses other values; a value that is bound to it may be 0 before the first message."""
    items = '<SimpleType name="Mode"><Enumeration><Item name="on" value="2"/><Item name="off" value="1"/></Enumeration>'
    folder = changed(
        FMU2,
        tmp_path / "fmu",
        "modelDescription.xml",
        ("<TypeDefinitions>", f"<TypeDefinitions>{items}</SimpleType>"),
        ('<Integer start="0"/>', '<Enumeration declaredType="Mode" start="1"/>'),
    )
    code = folder / "sources/servo.c"
    take = "((servo_t *)c)->integers[vr[i]] = value[i];"
    assert take in code.read_text()
    code.write_text(code.read_text().replace(take, f"if (value[i] < 1 || value[i] > 2) {{ return fmi2Error; }} {take}"))
    library = build(loaded(folder), "pan", tmp_path)
    assert run_wrapper(library, 30) == run_fmu2(tmp_path / "direct", 30)


def test_an_archive_is_unpacked_the_same_each_time(tmp_path: Path) -> None:
    model = loaded(pack(FMU2, tmp_path / "a.fmu", {"resources/a.txt": b"?"}))
    files = emit_model(model, "pan")
    assert files == emit_model(loaded(pack(FMU2, tmp_path / "b.fmu")), "pan")
    unpacked = {name for name in files if name.startswith("pan_fmu/")}
    assert unpacked == {f"pan_fmu/sources/{name}" for name in ("servo.c", "law.c", "law.h")}
    assert files["pan_fmu/sources/law.c"] == (FMU2 / "sources/law.c").read_text()
    made = model_build(model, "pan")
    assert made.exported == () and made.include_dirs == () and made.generated_include_dirs == ("pan_fmu/sources",)
    assert set(made.exported_generated) == {"pan_export.c", "pan_fmu/sources/servo.c", "pan_fmu/sources/law.c"}


def program(body: str, libraries: list[Library], folder: Path, options: tuple[str, ...] = ()) -> list[list[float]]:
    """Lines of numbers of a program in which ``in`` and ``out`` are of the first library, ``a`` is its instance 0."""
    name = libraries[0].name
    includes = "".join(f'#include "{library.name}.h"\n' for library in libraries)
    text = f"""{includes}#include <math.h>
#include <stdio.h>
static {name}_inputs_t in;
static {name}_outputs_t out;
int main(void)
{{
    {name}_t *a = {name}_instance(0);
    {body}
    (void)a;
    return 0;
}}
"""
    output = run_program(folder, text, libraries, options)
    return [[float(word) for word in line.split()] for line in output.splitlines()]


SERVO = """
    in.plant_setpoint = 0.5; in.plant_position = 0.1; in.enable = 1.0;
"""
SHOW = 'printf("%.17g %.17g %.17g\\n", out.duty, out.steps, out.saturated);'


def test_starting_again_is_starting_afresh(tmp_path: Path) -> None:
    """Twenty times, with a heap that can contain one instance."""
    library = build(loaded(FMU2), "pan", tmp_path)
    body = f"""{SERVO}
    for (int i = 0; i < 20; i++) {{
        pan_init(a, &in, &out);
        {SHOW}
        pan_set_parameter(a, PAN_PI_KP, 1.0 + i);
        for (int k = 0; k < 10; k++) {{ pan_step(a, &in, &out); }}
        if (i % 2) {{ pan_terminate(a, &in, &out); }}
        printf("%lu %d\\n", pan_heap_used(a), pan_finite(a));
    }}
"""
    rows = program(body, [library], tmp_path / "run")
    starts, ends = rows[::2], rows[1::2]
    assert starts == [[0.5, 0, 0]] * 20
    assert len({tuple(end) for end in ends}) == 1 and ends[0][1] == 1
    assert 200 < ends[0][0] < 600


def test_parameters(tmp_path: Path) -> None:
    """Set at the start, set while running, and one that is fixed."""
    model = loaded(FMU2)
    body = f"""{SERVO}
    pan_init(a, &in, &out);
    pan_step(a, &in, &out);
    {SHOW}
    pan_set_parameter(a, PAN_PI_KP, 0.0);
    pan_set_parameter(a, PAN_TABLE_SIZE, 1.0);
    pan_set_parameter(a, (pan_parameter_t)77, 1.0);
    pan_step(a, &in, &out);
    {SHOW}
    printf("%g %g %g %g\\n", pan_get_parameter(a, PAN_PI_KP), pan_get_parameter(a, PAN_PI_KI),
           pan_get_parameter(a, PAN_TABLE_SIZE), pan_get_parameter(a, (pan_parameter_t)77));
"""
    first, second, values = program(body, [build(model, "pan", tmp_path / "a")], tmp_path / "ra")
    ki = 0.5 * 0.001
    assert first[0] == pytest.approx(0.4 / 4 * (2.0 + ki), rel=1e-12)
    assert second[0] == pytest.approx(0.4 / 4 * ki + 0.8 / 4 * ki, rel=1e-12)
    assert values == [0, 0.5, 4, 0]
    other = build(model, "pan", tmp_path / "b", {"table size": 1.0, "PI.kp": 0.25})
    first, _, values = program(body, [other], tmp_path / "rb")
    assert first[0] == pytest.approx(0.4 * (0.25 + ki), rel=1e-12)
    assert values == [0, 0.5, 1, 0]


def test_a_heap_that_is_too_small_is_seen(tmp_path: Path) -> None:
    folder = tmp_path / "model"
    folder.mkdir()
    (folder / "model.yaml").write_text("version: 1\nfmu: ../servo.fmu\nheap: 192 B\n")
    pack(FMU2, tmp_path / "servo.fmu")
    body = f"""{SERVO}
    pan_init(a, &in, &out);
    printf("%d %lu %u %d\\n", pan_finite(a), pan_heap_used(a), PAN_HEAP_SIZE, pan_stopped(a));
    pan_step(a, &in, &out);
    pan_set_parameter(a, PAN_PI_KP, 9.0);
    {SHOW}
    pan_terminate(a, &in, &out);
    printf("%d %g\\n", pan_finite(a), pan_get_parameter(a, PAN_PI_KP));
"""
    first, outputs, last = program(body, [build(loaded(folder), "pan", tmp_path)], tmp_path / "run")
    assert first[0] == 0 and first[2] == 192 < first[1] and first[3] == 0
    assert outputs == [0, 0, 0] and last == [0, 0]


def test_memory_in_a_step(tmp_path: Path) -> None:
    """Memory that is returned can be allocated again without end, in any order.

    Without a return, an allocation fails in the end, and this is detected.  The check of the
    sources does not detect the call through a pointer.
    """
    in_step = """
    if (self->integers[0] == 5) {
        char *a = malloc(30);
        char *b = strdup("a temporary text");
        a = realloc(a, 60);
        strcpy(a + 20, b);
        free(b);
        free(a);
    }
    if (self->integers[0] == 6 && take(800) == NULL) {
        return fmi2OK;
    }
    if (self->integers[0] == 1008) {"""
    folder = changed(
        FMU2,
        tmp_path / "fmu",
        "sources/servo.c",
        ("static double limit", "static void *(*volatile take)(size_t) = malloc;\nstatic double limit"),
        ("    if (self->integers[0] == 1008) {", in_step.lstrip("\n")),
    )
    body = f"""{SERVO}
    pan_init(a, &in, &out);
    for (int k = 0; k < 5000; k++) {{ in.mode = k % 2 ? 5.0 : 0.0; pan_step(a, &in, &out); }}
    unsigned long used = pan_heap_used(a);
    printf("%d %d\\n", pan_finite(a), used < 800u);
    in.mode = 6.0;
    int k = 0;
    while (k < 1000 && pan_finite(a)) {{ pan_step(a, &in, &out); k++; }}
    printf("%d %d\\n", k, pan_heap_used(a) > PAN_HEAP_SIZE);
    pan_init(a, &in, &out);
    printf("%d %d\\n", pan_finite(a), pan_heap_used(a) < 800u);
"""
    sanitize = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
    library = build(loaded(folder), "pan", tmp_path, options=sanitize)
    rows = program(body, [library], tmp_path / "run", sanitize)
    assert rows == [[1, 1], [20, 1], [1, 1]]


def test_errors_and_stopping(tmp_path: Path) -> None:
    """An FMU that fails or stops is not called again until it starts again."""
    body = f"""{SERVO}
    for (int mode = 1007; mode <= 1008; mode++) {{
        in.mode = 0.0;
        pan_init(a, &in, &out);
        pan_step(a, &in, &out);
        in.mode = mode;
        pan_step(a, &in, &out);
        printf("%d %d\\n", pan_finite(a), pan_stopped(a));
        in.mode = 0.0;
        pan_step(a, &in, &out);
        printf("%g\\n", out.steps);
    }}
    pan_init(a, &in, &out);
    printf("%d %d\\n", pan_finite(a), pan_stopped(a));
"""
    rows = program(body, [build(loaded(FMU2), "pan", tmp_path)], tmp_path / "run")
    assert rows == [[0, 0], [1], [1, 1], [1], [1, 0]]


def test_states_that_are_not_finite_are_found(tmp_path: Path) -> None:
    """The limiter hides the state from the output."""
    body = f"""{SERVO}
    pan_init(a, &in, &out);
    pan_step(a, &in, &out);
    printf("%d\\n", pan_finite(a));
    pan_set_parameter(a, PAN_PI_KI, 1e308);
    in.plant_setpoint = 1e300;
    pan_step(a, &in, &out);
    printf("%d %g\\n", pan_finite(a), out.duty);
"""
    first, second = program(body, [build(loaded(FMU2), "pan", tmp_path)], tmp_path / "run")
    assert first == [1] and second == [0, 1]


def test_two_instances_and_two_fmus_at_once(tmp_path: Path) -> None:
    """Both have the same sources and therefore the same names."""
    servo, axes = loaded(FMU2), loaded(FMU3)
    libraries = [
        build(servo, "pan", tmp_path, instances=2),
        build(servo, "tilt", tmp_path),
        build(axes, "axes", tmp_path, instances=2),
    ]
    body = f"""{SERVO}
    static pan_inputs_t in2 = {{-0.5, 0.1, 1.0, 0.0}};
    static tilt_inputs_t tin = {{0.5, 0.1, 1.0, 0.0}};
    static axes_inputs_t ain = {{1.0, 2.0, 3.0, 0.5, 7.0, 0.0}};
    pan_outputs_t out2; tilt_outputs_t tout; axes_outputs_t aout;
    pan_t *b = pan_instance(1);
    tilt_t *t = tilt_instance(0);
    pan_init(a, &in, &out); pan_init(b, &in2, &out2); tilt_init(t, &tin, &tout);
    axes_init(axes_instance(0), &ain, &aout); axes_init(axes_instance(1), &ain, &aout);
    tilt_set_parameter(t, TILT_PI_KP, 1.0);
    for (int k = 0; k < 50; k++) {{
        pan_step(a, &in, &out); pan_step(b, &in2, &out2); tilt_step(t, &tin, &tout);
        if (k < 10) {{ axes_step(axes_instance(1), &ain, &aout); }}
    }}
    printf("%.17g\\n%.17g\\n%.17g %.17g\\n%g\\n", out.duty, out2.duty, tout.duty, tout.steps, aout.count);
    axes_step(axes_instance(0), &ain, &aout);
    printf("%g\\n", aout.count);
    return pan_instance(2) != 0 || PAN_INSTANCES != 2u;
"""
    together = program(body, libraries, tmp_path / "run")
    alone = []
    for setpoint, kp in ((0.5, 2.0), (-0.5, 2.0), (0.5, 1.0)):
        text = f"""{SERVO} in.plant_setpoint = {setpoint};
    tilt_init(a, &in, &out); tilt_set_parameter(a, TILT_PI_KP, {kp});
    for (int k = 0; k < 50; k++) {{ tilt_step(a, &in, &out); }}
    printf("%.17g %.17g\\n", out.duty, out.steps);
"""
        alone.append(program(text, [libraries[1]], tmp_path / f"alone{setpoint}{kp}")[0])
    assert together[:3] == [alone[0][:1], alone[1][:1], alone[2]]
    assert together[3:] == [[10], [1]]
    assert alone[0] != alone[2]


def test_fmi3_stops_and_fails(tmp_path: Path) -> None:
    body = """
    in.gain = 1.0;
    pan_init(a, &in, &out);
    in.mask = 1000.0;
    pan_step(a, &in, &out);
    printf("%d %d %g\\n", pan_finite(a), pan_stopped(a), out.count);
    in.mask = -5.0;
    pan_init(a, &in, &out);
    in.gain = 99.0;
    pan_step(a, &in, &out);
    printf("%d %d %g\\n", pan_finite(a), pan_stopped(a), out.count);
"""
    rows = program(body, [build(loaded(FMU3), "pan", tmp_path)], tmp_path / "run")
    assert rows == [[1, 1, 1], [0, 0, 0]]


@pytest.mark.parametrize("cpu", ["cortex-m0plus", "cortex-m33"])
def test_links_for_microcontrollers(cpu: str, tmp_path: Path) -> None:
    """Without a heap of the C library: no code in the image allocates memory."""
    compiler = shutil.which("arm-none-eabi-gcc")
    if compiler is None:
        pytest.skip("arm-none-eabi-gcc is not installed: sudo apt install gcc-arm-none-eabi libnewlib-arm-none-eabi")
    flags = [f"-mcpu={cpu}", "-mthumb", "-Os", "-std=c11", "-ffunction-sections", "-ffp-contract=off"]
    objects: list[Path] = []
    for name, model in (("pan", loaded(FMU2)), ("axes", loaded(pack(FMU3, tmp_path / "a.fmu")))):
        output = tmp_path / name
        for file, text in emit_model(model, name).items():
            (output / file).parent.mkdir(parents=True, exist_ok=True)
            (output / file).write_text(text)
        made = model_build(model, name)
        folders = [*made.include_dirs, *(output / place for place in made.generated_include_dirs)]
        own = ["-w", "-include", str(output / f"{name}_names.h"), *(f"-I{folder}" for folder in folders)]
        own += [f"-I{output}", f"-I{output}/{name}_headers"]
        sources = [(output / file, ["-Wall", "-Wextra", "-Wconversion", "-Werror"]) for file in made.generated]
        exported = [*((output / file) for file in made.exported_generated), *made.exported]
        first = len(objects)

        def compiled(source: Path, options: Sequence[str], folder: Path = output) -> None:
            objects.append(folder / f"{len(objects)}.o")
            run([compiler, *flags, *options, INCLUDE, f"-I{folder}", "-c", str(source), "-o", str(objects[-1])])

        for source in exported:
            compiled(source, own)
        table, runtime = sources_of_variables(name, output, objects[first:])
        sources += [(table, [])] + ([(runtime, [])] if name == "pan" else [])
        for source, options in sources:
            compiled(source, options)
    main = tmp_path / "main.c"
    main.write_text("""
#include "pan/pan.h"
#include "axes/axes.h"
int main(void)
{
    static pan_inputs_t in;
    static pan_outputs_t out;
    static axes_inputs_t axes_in;
    static axes_outputs_t axes_out;
    pan_init(pan_instance(0), &in, &out);
    axes_init(axes_instance(0), &axes_in, &axes_out);
    pan_step(pan_instance(0), &in, &out);
    axes_step(axes_instance(0), &axes_in, &axes_out);
    return pan_finite(pan_instance(0)) && axes_finite(axes_instance(0)) ? 0 : 1;
}
""")
    image, map_file = tmp_path / "image.elf", tmp_path / "image.map"
    linking = ["--specs=nosys.specs", "-Wl,--gc-sections,--no-warn-rwx-segments", f"-Wl,-Map={map_file}"]
    run([compiler, *flags, str(main), *map(str, objects), "-lm", *linking, "-o", str(image)])
    symbols = run(["arm-none-eabi-nm", str(image)])
    names = {line.split()[-1] for line in symbols.splitlines()}
    assert "pan_private_fmi2DoStep" in names and "axes_private_fmi3DoStep" in names
    assert not names & {"malloc", "_malloc_r", "calloc", "_sbrk", "strdup"}
