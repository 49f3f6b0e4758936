# SPDX-License-Identifier: Apache-2.0
"""A start is a start: a model that is initialised again runs as it did first, bit for bit.

The models of these tests keep state in every place where C and C++ have variables, and never reset it themselves.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics, UserError
from epg.generator.documents.coff_file import CoffObject
from epg.generator.documents.elf_file import ElfObject
from epg.generator.emit.model.variables import model_variables
from tests.doubles.twenty_sim.exports import Export
from tests.models.fmus import FMU2, FMU3, changed, pack
from tests.models.harness import MODELS, SIGNAL, Library, build, compile_file, loaded, run, run_program
from tests.twenty_sim.generate import write_by_template

EXAMPLES = MODELS.parent.parent / "examples"

#: A function with state that nothing resets.
WEAR = (MODELS / "worn" / "wear.c").read_text(encoding="utf-8")

#: The same in C++, with objects that are constructed before main() and in the first call, and with destructors.
WEAR_CPP = """
namespace worn {
template <typename T> struct Counter {
    static int all;
    T value;
    explicit Counter(T start) : value(start) { all++; }
    ~Counter() { all = -1000; }
};
template <typename T> int Counter<T>::all = 3;
static double seed() { static double next = 0.25; next *= 2.0; return next; }
static Counter<double> early(seed() * seed());
static const double first = seed();
}
double wear_cpp()
{
    static worn::Counter<double> late(worn::seed());
    worn::early.value += 1.0;
    late.value *= 1.5;
    return worn::early.value + late.value + worn::Counter<double>::all + worn::first;
}
"""

YAML = """version: 1
step: 1 ms
{keys}style: arrays
inputs: {{level: , other: }}
outputs: {{worn: , same: }}
functions: {{step: worn_step{init}}}
"""
STEP = "void worn_step({instance}const double *u, double *y) {{ y[0] = wear(0) * u[0]{more}; }}\n"
INIT = "void worn_init({instance}const double *u, double *y) {{ y[1] += wear(0){more}; }}\n"


def hand_written(folder: Path, cpp: bool = False, instance: bool = False, init: bool = True) -> Path:
    """A model whose second output is written by its init function alone."""
    folder.mkdir(parents=True)
    given = "worn_t *self, " if instance else ""
    more = (" + wear_cpp()" if cpp else "") + (" + self->count++" if instance else "")
    struct = "typedef struct { double count; } worn_t;\n" if instance else ""
    step, start = STEP.format(instance=given, more=more), INIT.format(instance=given, more=more) if init else ""
    heads = "".join(f"{text[: text.index(' {')]};\n" for text in (step, start) if text)
    suffix = "cpp" if cpp else "c"
    (folder / "worn.h").write_text(f"#pragma once\n{struct}{heads}")
    (folder / f"worn.{suffix}").write_text(f'#include "worn.h"\n{WEAR}{WEAR_CPP if cpp else ""}{step}{start}')
    keys = f"header: worn.h\nsources: [worn.{suffix}]\n"
    keys += ("language: c++\n" if cpp else "") + ("instance: worn_t\n" if instance else "")
    (folder / "model.yaml").write_text(YAML.format(keys=keys, init=", init: worn_init" if init else ""))
    return folder


#: An equation that begins with the value of an output of the step before, or of the run before.
CARRIED = "\tV[6] = V[6] + 1e-3 * V[0];\n"


def worn(**more: str) -> Export:
    dynamic = CARRIED + "\tV[6] = V[6] + wear (0);\n"
    return Export(dynamic=dynamic, functions=WEAR, declarations="double wear (int unused);", **more)


def without_reset(folder: Path) -> Path:
    """A C++ class in which only the constructor clears the arrays."""
    for path in worn().write_cpp(folder).rglob("*.*"):
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace("Reset(", "ClearAll("), encoding="utf-8")
    return folder


def fmu2(folder: Path) -> Path:
    head = '#include "law.h"\n'
    return changed(
        FMU2, folder, "sources/law.c", (head, head + WEAR), ("return limit(duty);", "return limit(duty) + wear(0);")
    )


def fmu3(folder: Path) -> Path:
    """An FMU that does not clear the memory that it allocates."""
    changes = (
        ("int instances = 1;", f"int instances = 1;\n{WEAR}"),
        ("calloc(1, sizeof(axes_t))", "malloc(sizeof(axes_t))"),
        ("self->count += 1;", "self->count += 1 + (fmi3Int64)(1000.0 * wear(0));"),
    )
    return changed(FMU3, folder, "sources/axes.c", *changes)


MAKERS: dict[str, Callable[[Path], Path]] = {
    "20-sim C": lambda folder: worn().write(folder),
    "20-sim C, Runge Kutta 4": lambda folder: worn(method="RungeKutta4").write(folder),
    "20-sim C++": lambda folder: worn().write_cpp(folder),
    "20-sim C++ without Reset": without_reset,
    "20-sim tokens": lambda folder: Export(dynamic=CARRIED).write_tokens(folder),
    "EPG's target for 20-sim": lambda folder: write_by_template(Export(dynamic=CARRIED), folder),
    "sources of an FMU of 20-sim 4.5": lambda folder: worn().write_fmu(folder, False),
    "sources of an FMU of 20-sim 4.6": lambda folder: worn().write_fmu(folder, True),
    "FMU of 20-sim 4.5": lambda folder: worn().write_whole_fmu(folder, "globals"),
    "FMU of 20-sim 4.6": lambda folder: worn().write_whole_fmu(folder, "instance"),
    "FMU of 20-sim 4.6.3": lambda folder: worn().write_whole_fmu(folder, "output time"),
    "FMU of FMI 2.0": fmu2,
    "FMU of FMI 3.0": fmu3,
    "packed FMU of FMI 3.0": lambda folder: pack(fmu3(folder), folder.parent / "axes.fmu"),
    "hand-written C": lambda folder: hand_written(folder),
    "hand-written C without init": lambda folder: hand_written(folder, init=False),
    "hand-written C with instance": lambda folder: hand_written(folder, instance=True),
    "hand-written C++": lambda folder: hand_written(folder, cpp=True),
    "hand-written C++ with instance": lambda folder: hand_written(folder, cpp=True, instance=True),
}
EXPORTS = {
    f"{example}/{kind}": EXAMPLES / example / kind
    for example, kind in (
        ("jiwy", "model"),
        ("jiwy", "plant"),
        ("relbot", "model"),
        ("relbot", "plant"),
        ("ping_pong", "model"),
        ("network_situations", "hand"),
        ("production_cell", "arm"),
        ("production_cell", "belt"),
        ("production_cell", "door"),
        ("production_cell", "feeder"),
        ("production_cell", "plant"),
        ("existing_zephyr_application", "model"),
        ("existing_cubemx_repository", "controller"),
    )
}


def driver(library: Library, runs: int = 3, steps: int = 60) -> str:
    """C that runs the model several times with the same inputs, and prints the outputs of each run in one line."""
    name, model = library.name, library.model
    take = " ".join(f"in.{port.identifier} = signal();" for port in model.inputs)
    show = " ".join(f"show(out.{port.identifier});" for port in model.outputs)
    change = "".join(f"{name}_set_parameter(self, ({name}_parameter_t)0, 0.75);" for _ in model.parameters[:1])
    return f"""{SIGNAL}
#include "{name}.h"
int main(void)
{{
    static {name}_inputs_t in;
    {name}_outputs_t out;
    {name}_t *self = {name}_instance(0);
    for (int r = 0; r < {runs}; r++) {{
        signal_state = 88172645463325252u;
        {take}
        {name}_init(self, &in, &out);
        {show}
        for (int k = 0; k < {steps} + 7 * r; k++) {{
            {take}
            {name}_step(self, &in, &out);
            if (k < {steps}) {{ {show} }}
        }}
        puts("");
        {change}
    }}
    return 0;
}}
"""


def runs(library: Library, folder: Path, options: tuple[str, ...] = ()) -> list[str]:
    lines = run_program(folder / "run", driver(library), [library], options).splitlines()
    assert len(lines) == 3
    assert len(set(lines[0].split())) > 10, "the outputs must change"
    return lines


@pytest.mark.parametrize("options", [("-O3", "-fPIE"), ("-fsanitize=address,undefined",)], ids=["O3", "asan"])
@pytest.mark.parametrize("maker", sorted(MAKERS))
def test_each_run_is_the_first(maker: str, options: tuple[str, ...], tmp_path: Path) -> None:
    library = build(loaded(MAKERS[maker](tmp_path / "model")), "pan", tmp_path, options=options)
    first, *others = runs(library, tmp_path, options)
    assert others == [first, first]


@pytest.mark.parametrize("example", sorted(EXPORTS))
def test_the_models_of_the_examples(example: str, tmp_path: Path) -> None:
    library = build(loaded(EXPORTS[example]), "pan", tmp_path)
    text = driver(library)
    lines = run_program(tmp_path / "run", text, [library]).splitlines()
    assert lines[1:] == [lines[0], lines[0]]


def refusal(model: Path, folder: Path, instances: int = 1, options: tuple[str, ...] = ()) -> str:
    """The reason why a model cannot be restarted."""
    with pytest.raises(UserError) as raised:
        build(loaded(model), "pan", folder, instances=instances, options=options)
    messages = {f"{item.id}: {item.message}" for item in raised.value.diagnostics}
    assert len(messages) == 1
    return re.sub(r"^model-not-restartable: .*?: ", "", *messages)


def test_a_variable_of_a_thread(tmp_path: Path) -> None:
    for cpp, word in ((False, "_Thread_local"), (True, "thread_local")):
        folder = hand_written(tmp_path / word / "model", cpp)
        source = next(folder.glob("worn.c*"))
        source.write_text(source.read_text().replace("static double gain", f"static {word} double gain"))
        assert refusal(folder, tmp_path / word) == "variable 'gain' exists once for each thread"


def test_a_variable_that_all_instances_share(tmp_path: Path) -> None:
    """One instance can have it: it is restored.  Several instances must not restore it."""
    for cpp in (False, True):
        folder = hand_written(tmp_path / str(cpp) / "model", cpp, instance=True)
        source = next(folder.glob("worn.c*"))
        text = "double wear(int unused) { static double shared = 0.5; return shared *= 1.5; }\n"
        text = source.read_text().replace(WEAR, text).replace(WEAR_CPP, "").replace(" + wear_cpp()", "")
        source.write_text(text)
        build(loaded(folder), "one", tmp_path / str(cpp))
        reason = "belongs to all instances, so the start of one of them would change the others"
        assert refusal(folder, tmp_path / str(cpp), instances=2) == f"variable 'shared' {reason}"
        source.write_text(text.replace("static double", "const double").replace("shared *= 1.5", "shared"))
        build(loaded(folder), "two", tmp_path / str(cpp), instances=2)


def test_an_object_file_of_link_time_optimisation(tmp_path: Path) -> None:
    """GCC's has the usual format, but no variables: their names are in a section of their own."""
    source = tmp_path / "model.c"
    source.write_text("int counted; int count(void) { return ++counted; }")
    made = compile_file(source, tmp_path / "model.o", ["-flto"], "c")
    with pytest.raises(UserError) as raised:
        model_variables("pan", 1, [made], Diagnostics())
    (item,) = raised.value.diagnostics
    assert "link-time optimisation" in item.message


def test_variables_that_other_code_can_share(tmp_path: Path) -> None:
    """Common symbols of old C, and variables of inline functions of C++."""
    for suffix, text in (
        ("c", "int both;"),
        ("cpp", "inline int *f() { static int both = 3; return &both; } int *g() { return f(); }"),
    ):
        source = tmp_path / f"model.{suffix}"
        source.write_text(text)
        made = compile_file(
            source, tmp_path / f"{suffix}.o", ["-fcommon"] if suffix == "c" else [], "c" if suffix == "c" else "c++"
        )
        with pytest.raises(UserError) as raised:
            model_variables("pan", 1, [made], Diagnostics())
        assert all("variable 'both'" in item.message for item in raised.value.diagnostics)


def test_destructors_do_not_pile_up(tmp_path: Path) -> None:
    """Each start constructs the object of a function again.  The end of the program destroys none of them."""
    folder = hand_written(tmp_path / "model", cpp=True)
    source = folder / "worn.cpp"
    source.write_text("#include <cstdio>\n" + source.read_text().replace("all = -1000;", 'std::puts("destroyed");'))
    library = build(loaded(folder), "pan", tmp_path)
    lines = run_program(tmp_path / "run", driver(library), [library]).splitlines()
    assert len(lines) == 3 and lines[1:] == [lines[0], lines[0]]


@pytest.mark.parametrize(
    ("prefix", "options", "zero"),
    [
        ("", [], {".bss"}),
        ("", ["-fdata-sections"], {".bss.total", ".bss.calls"}),
        ("arm-none-eabi-", ["-mcpu=cortex-m0plus", "-mthumb"], {".bss"}),
        ("arm-none-eabi-", ["-mcpu=cortex-m7", "-mthumb", "-mbig-endian"], {".bss"}),
        ("riscv64-unknown-elf-", ["-march=rv32imac", "-mabi=ilp32"], {".sbss"}),
        ("x86_64-w64-mingw32-", [], {".bss"}),
        ("i686-w64-mingw32-", [], {".bss"}),
    ],
    ids=["host", "data-sections", "arm", "big-endian", "riscv", "windows", "windows-32"],
)
def test_the_sections_of_each_compiler(prefix: str, options: list[str], zero: set[str], tmp_path: Path) -> None:
    """All variables are in the table, and the linker knows the symbols of their sections."""
    if shutil.which(f"{prefix}gcc") is None:
        pytest.skip(f"{prefix}gcc is not installed")
    made, copy = tmp_path / "wear.o", tmp_path / "copy.o"
    run([f"{prefix}gcc", *options, "-fno-common", "-O2", "-c", str(MODELS / "worn/wear.c"), "-o", str(made)])
    (copied,), table = model_variables("pan", 1, [made], Diagnostics())
    copy.write_bytes(copied)
    read = CoffObject if "mingw" in prefix else ElfObject
    sections = read(made.read_bytes()).sections()
    assert {re.sub(r"\.\d+$", "", section.name) for section in sections if section.zero} == zero
    names = {variable.name for section in sections for variable in read(copied).variables(section.number)}
    assert {"table", "total", "newest", "odd", "letters"} <= names
    sizes = [section.size for section in sections if not section.zero]
    assert f"{sum(section.size for section in sections)} bytes, of which {sum(-(-s // 4) * 4 for s in sizes)}" in table
    linked = tmp_path / "linked.o"
    run([f"{prefix}gcc", *options, "-r", "-nostdlib", str(copy), "-o", str(linked)])
    symbols = re.findall(r"(\w+) \w _?(pan_export_section_0_\d+)", run([f"{prefix}nm", str(linked)]))
    assert sorted(name for _, name in symbols) == sorted(f"pan_export_section_0_{s.number}" for s in sections)
