# SPDX-License-Identifier: Apache-2.0
"""Programs that run an export through its own interface, as its authors do, to compare EPG's wrapper with them."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from epg.generator.importers.fmu.fmi_headers import fmi_headers
from tests.models.harness import SIGNAL, compile_file, link, run


def run_c_vectors(
    sources: list[Path],
    includes: list[Path],
    folder: Path,
    counts: tuple[int, int],
    steps: int,
    suffix: str = "",
    prefixes: tuple[str, str] = ("xx_", "XX"),
    argument: str = "",
) -> str:
    """Runs the C function target.  ``argument`` is the third argument of Calculate, by default the time."""
    variable, function = prefixes
    time = argument or f"{variable}time{suffix}"
    inputs, outputs = counts
    text = f"""{SIGNAL}
extern double {variable}time{suffix};
void {function}InitializeSubmodel{suffix}(double *u, double *y, double t);
void {function}CalculateSubmodel{suffix}(double *u, double *y, double t);
void {function}TerminateSubmodel{suffix}(double *u, double *y, double t);
{
        _main(
            inputs,
            outputs,
            steps,
            f"{function}InitializeSubmodel{suffix}(u, y, 0.0);",
            f"{function}CalculateSubmodel{suffix}(u, y, {time});",
            f"{function}TerminateSubmodel{suffix}(u, y, {time});",
        )
    }
"""
    return _run_c(text, sources, includes, folder)


def run_cpp_class(
    folder_of_model: Path,
    name: str,
    folder: Path,
    counts: tuple[int, int],
    steps: int,
    sources: list[Path] | None = None,
    includes: list[Path] | None = None,
) -> str:
    """Runs the C++ class target like its test program, but without an end of the experiment.

    ``sources`` and ``includes`` are for exports whose files are in other places than 20-sim's.
    """
    text = f"""{SIGNAL}
#include <stddef.h>
#include "{name}.h"
static {name} model;
{
        _main(
            counts[0],
            counts[1],
            steps,
            "model.SetFinishTime(0.0); model.Initialize(u, y, 0.0);",
            "model.Calculate(u, y);",
            "model.Terminate(u, y);",
            "XXDouble",
        )
    }
"""
    folder.mkdir(parents=True, exist_ok=True)
    main = folder / "direct.cpp"
    main.write_text(text, encoding="utf-8")
    own = sources or [folder_of_model / f"{name}.cpp", *sorted((folder_of_model / "common").glob("*.cpp"))]
    options = ["-w", *(f"-I{place}" for place in [folder_of_model, *(includes or [])])]
    objects = [compile_file(source, folder / f"direct_{i}.o", options, "c++") for i, source in enumerate([main, *own])]
    return run([str(link(objects, folder / "direct", True))])


def run_fmu(sources: Path, folder: Path, inputs: list[str], outputs: list[str], steps: int) -> str:
    """Runs the C sources of an FMU of 20-sim through its FMI 2.0 functions, step by step at the sum of its steps.

    ``inputs`` and ``outputs`` are names of variables.
    """
    description = ElementTree.parse(sources.parent / "modelDescription.xml").getroot()
    variables = {v.attrib["name"]: v for v in description.iter("ScalarVariable")}
    step = description.find("DefaultExperiment").attrib["stepSize"]  # type: ignore[union-attr]
    guid = description.attrib["guid"]

    def set_input(name: str) -> str:
        reference = variables[name].attrib["valueReference"]
        # the interface gives no access to the raw values of booleans, but reals use the same memory
        return f"{{ fmi2ValueReference r = {reference}; double v = signal(); fmi2SetReal(c, &r, 1, &v); }}"

    def show_output(name: str) -> str:
        reference = variables[name].attrib["valueReference"]
        return f"{{ fmi2ValueReference r = {reference}; double v; fmi2GetReal(c, &r, 1, &v); show(v); }}"

    take = "\n        ".join(map(set_input, inputs))
    show = " ".join(map(show_output, outputs))
    text = f"""{SIGNAL}
#include <stdlib.h>
#include "fmi2Functions.h"
static void logger(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c, fmi2String m, ...) {{}}
int main(void)
{{
    static const fmi2CallbackFunctions callbacks = {{logger, calloc, free, NULL, NULL}};
    fmi2Component c = fmi2Instantiate("model", fmi2CoSimulation, "{guid}", "file:///tmp", &callbacks, 0, 0);
    fmi2SetupExperiment(c, 0, 0.0, 0.0, 1, 1e9);
    fmi2EnterInitializationMode(c);
    fmi2ExitInitializationMode(c);
    {show} puts("");
    double time = 0.0;
    for (int k = 0; k < {steps}; k++) {{
        {take}
        if (fmi2DoStep(c, time, {step}, 1) != fmi2OK) {{ return 1; }}
        time += {step};
        {show} puts("");
    }}
    fmi2Terminate(c);
    {show} puts("");
    return 0;
}}
"""
    listed = [sources / file.attrib["name"] for file in description.iter("File")]
    files = listed or sorted(sources.glob("*.c"))
    headers = folder / "standard"  # searched last: the FMU's own go first
    headers.mkdir(parents=True, exist_ok=True)
    for name, header in fmi_headers(2).items():
        (headers / name).write_text(header)
    return _run_c(text, files, [sources, headers], folder, ["-DNO_FUNCTION_PREFIX"])


def _main(
    inputs: int, outputs: int, steps: int, init: str, calculate: str, terminate: str, real: str = "double"
) -> str:
    take = f"for (int i = 0; i < {inputs}; i++) {{ u[i] = signal(); }}"
    show = f'for (int i = 0; i < {outputs}; i++) {{ show(y[i]); }} puts("");'
    return f"""
int main(void)
{{
    {real} u[{inputs} + 1] = {{0}};
    {real} y[{outputs} + 1] = {{0}};
    {take}
    {init}
    {show}
    for (int k = 0; k < {steps}; k++) {{
        {take}
        {calculate}
        {show}
    }}
    {terminate}
    {show}
    return 0;
}}"""


def _run_c(text: str, sources: list[Path], includes: list[Path], folder: Path, options: list[str] | None = None) -> str:
    folder.mkdir(parents=True, exist_ok=True)
    main = folder / "direct.c"
    main.write_text(text, encoding="utf-8")
    flags = ["-w", *(f"-I{path}" for path in includes), *(options or [])]
    objects = [compile_file(path, folder / f"direct_{i}.o", flags, "c") for i, path in enumerate([main, *sources])]
    return run([str(link(objects, folder / "direct", False))])


def has_entry_points(path: Path) -> bool:
    """True if a C file defines the functions of a submodel."""
    pattern = r"^\w+[ \t]+\w*InitializeSubmodel\w*\s*\([^;{}()]*\)\s*\{"
    return re.search(pattern, path.read_text("latin-1"), re.MULTILINE) is not None
