# SPDX-License-Identifier: Apache-2.0
"""Builds a model's library with this computer's compiler and runs it, or the model's own code, step by step.

Both print the bits of every output of every step, so that the comparison of results is exact.  Inputs are a fixed
sequence of pseudo-random numbers.
"""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.model import emit_model, model_build
from epg.generator.emit.model.variables import model_variables
from epg.generator.importers import Model, load_model

MODELS = Path(__file__).resolve().parent
HAVE_COMPILER = shutil.which("gcc") is not None and shutil.which("g++") is not None
RUNTIME = MODELS.parent.parent / "targets" / "runtime"
INCLUDE = f"-I{RUNTIME / 'include'}"
STRICT = ["-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Wshadow", "-Wmissing-prototypes", "-Werror"]
COMMON = ["-O1", "-ffp-contract=off"]

#: Inputs of every step, the same in every program.
SIGNAL = """
#include <stdint.h>
#include <stdio.h>
#include <string.h>
static uint64_t signal_state = 88172645463325252u;
static double signal(void)
{
    signal_state ^= signal_state << 13;
    signal_state ^= signal_state >> 7;
    signal_state ^= signal_state << 17;
    static const double scales[4] = {0.1, 1.0, 10.0, 100.0};
    return ((double)(int64_t)(signal_state >> 11) / 4503599627370496.0 - 1.0) * scales[signal_state & 3u];
}
static void show(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    printf("%016llx ", (unsigned long long)bits);
}
"""


@dataclass(frozen=True)
class Library:
    """A compiled model library."""

    name: str
    folder: Path
    objects: tuple[Path, ...]
    model: Model


def load(path: Path) -> tuple[Model | None, Diagnostics]:
    diagnostics = Diagnostics()
    return load_model(path, diagnostics), diagnostics


def loaded(path: Path) -> Model:
    """The model at ``path``, which must load without an error."""
    model, diagnostics = load(path)
    assert model is not None, [item.message for item in diagnostics]
    assert not diagnostics.has_errors
    return model


def compile_file(source: Path, output: Path, options: Sequence[str], language: str) -> Path:
    compiler = ["g++", "-std=c++17", "-fno-exceptions", "-fno-rtti"] if language == "c++" else ["gcc", "-std=c11"]
    output.parent.mkdir(parents=True, exist_ok=True)
    run([*compiler, *COMMON, *options, "-c", str(source), "-o", str(output)])
    return output


def build(
    model: Model,
    name: str,
    folder: Path,
    parameters: Mapping[str, float] | None = None,
    instances: int = 1,
    options: Sequence[str] = (),
) -> Library:
    """The library of ``model``, built like EPG's CMake functions do it."""
    output = folder / name
    for file, text in emit_model(model, name, parameters, instances).items():
        path = output / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    made = model_build(model, name, parameters)
    objects = [
        compile_file(output / file, output / f"{file}.o", [*STRICT, *options, f"-I{output}", INCLUDE], "c")
        for file in made.generated
    ]
    private = [
        "-w",
        *options,
        *(f"-I{directory}" for directory in made.include_dirs),
        *(f"-I{output}/{directory}" for directory in made.generated_include_dirs),
        f"-I{output}",
        f"-I{output}/{name}_headers",
    ]
    if made.forced_header:
        private += ["-include", str(output / made.forced_header)]
    own = [(output / file, output / f"{file}.o") for file in made.exported_generated]
    own += [(path, output / f"exported_{index}_{path.name}.o") for index, path in enumerate(made.exported)]
    private += ["-fno-common", "-fno-data-sections"]
    exported = [compile_file(source, target, private, made.language) for source, target in own]
    for source in sources_of_variables(name, output, exported, instances):
        objects.append(compile_file(source, output / f"{source.name}.o", [*STRICT, *options, INCLUDE], "c"))
    return Library(name, output, (*objects, *exported), model)


def sources_of_variables(name: str, folder: Path, exported: Sequence[Path], instances: int = 1) -> tuple[Path, Path]:
    """The C files with which a model restarts.  The object files ``exported`` get the symbols that they need."""
    copies, table = model_variables(name, instances, exported, Diagnostics())
    for path, copy in zip(exported, copies, strict=True):
        path.write_bytes(copy)
    made = folder / f"{name}_export_variables.c"
    made.write_text(table, encoding="utf-8")
    return made, RUNTIME / "src" / "model" / "variables.c"


def link(objects: Iterable[Path], output: Path, cpp: bool, options: Sequence[str] = ()) -> Path:
    objects = list(objects)
    again = [path for path in objects if path.name == "variables.c.o"][1:]  # a linker takes it from one library only
    objects = [path for path in objects if path not in again]
    run(["g++" if cpp else "gcc", *options, *map(str, objects), "-lm", "-o", str(output)])
    return output


def run(command: Sequence[str], timeout: float = 120) -> str:
    environment = {**os.environ, "LC_ALL": "C"}
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, env=environment)
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
    return done.stdout


def lines(text: str) -> list[list[str]]:
    return [line.split() for line in text.splitlines()]


def values(text: str) -> list[list[float]]:
    """The numbers for printed bits."""
    return [[struct.unpack(">d", bytes.fromhex(word))[0] for word in line] for line in lines(text)]


def wrapper_driver(library: Library, steps: int, zero_start: bool = False) -> str:
    """C that runs instance 0 of a library and prints all outputs."""
    name, model = library.name, library.model
    take = "\n        ".join(f"in.{port.identifier} = signal();" for port in model.inputs)
    start = "" if zero_start else take
    show = "".join(f"show(out.{port.identifier}); " for port in model.outputs)
    return f"""{SIGNAL}
#include "{name}.h"
int main(void)
{{
    static {name}_inputs_t in;
    {name}_outputs_t out;
    {name}_t *self = {name}_instance(0);
    (void)signal;
    {start}
    {name}_init(self, &in, &out);
    {show} puts("");
    for (int k = 0; k < {steps}; k++) {{
        {take}
        {name}_step(self, &in, &out);
        {show} puts("");
    }}
    {name}_terminate(self, &in, &out);
    {show} puts("");
    return !{name}_finite(self);
}}
"""


def run_wrapper(library: Library, steps: int, zero_start: bool = False, options: Sequence[str] = ()) -> str:
    main = library.folder / "main.c"
    main.write_text(wrapper_driver(library, steps, zero_start), encoding="utf-8")
    objects = [compile_file(main, library.folder / "main.o", [f"-I{library.folder}", *options], "c"), *library.objects]
    return run([str(link(objects, library.folder / "program", True, options))])


def run_program(folder: Path, text: str, libraries: Sequence[Library], options: Sequence[str] = ()) -> str:
    """Compiles ``text`` as strictly as users may, links it with the libraries, and runs it."""
    folder.mkdir(parents=True, exist_ok=True)
    main = folder / "main.c"
    main.write_text(text, encoding="utf-8")
    includes = [f"-I{library.folder}" for library in libraries]
    objects = [compile_file(main, folder / "main.o", [*includes, *options], "c")]
    objects += [made for library in libraries for made in library.objects]
    return run([str(link(objects, folder / "program", True, options))])
