# SPDX-License-Identifier: Apache-2.0
"""Sample FMUs for tests, and programs that call their functions as the standard requires, to compare EPG's library with
them."""

from __future__ import annotations

import re
import shutil
import xml.etree.ElementTree as ElementTree
import zipfile
from collections.abc import Mapping
from pathlib import Path

from epg.generator.importers.fmu.fmi_headers import fmi_headers
from tests.models.harness import MODELS, SIGNAL, compile_file, link, run

FMU2 = MODELS / "fmu2"
FMU3 = MODELS / "fmu3"


def pack(folder: Path, archive: Path, more: Mapping[str, bytes] | None = None) -> Path:
    """Packs the folder as an ``.fmu``, with ``more`` files in it."""
    archive.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                packed.write(path, path.relative_to(folder).as_posix())
        for name, data in (more or {}).items():
            packed.writestr(name, data)
    return archive


def changed(folder: Path, target: Path, file: str, *changes: tuple[str, str]) -> Path:
    """A copy of an FMU with another text in one of its files."""
    shutil.copytree(folder, target)
    path = target / file
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")
    return target


def _main(start: str, take: str, step: str, show: str, end: str, steps: int) -> str:
    return f"""
int main(void)
{{
    {take}
    {start}
    {show}
    for (int k = 0; k < {steps}; k++) {{
        double t = k * STEP;
        double h = STEP;
        {take}
        {step}
        {show}
    }}
    {end}
    {show}
    return 0;
}}
"""


def run_fmu2(work: Path, steps: int) -> str:
    """The outputs of ``fmu2`` with the inputs of ``wrapper_driver``: its ports in the order of its description."""
    set_all = """
    reals[0] = signal(); reals[1] = signal(); enable = signal() != 0.0;
    mode = (int)round(signal());"""
    text = f"""#define FMI2_FUNCTION_PREFIX Servo_
#include "fmi2Functions.h"
#include <math.h>
#include <stdlib.h>
#define STEP 0.001
{SIGNAL}
static double reals[2];
static int enable, mode;
static fmi2Component c;
static void logger(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String g, fmi2String m, ...) {{ }}
static void set(void)
{{
    static const fmi2ValueReference inputs[2] = {{0, 1}};
    static const fmi2ValueReference zero = 0;
    fmi2SetReal(c, inputs, 2, reals);
    fmi2SetBoolean(c, &zero, 1, &enable);
    fmi2SetInteger(c, &zero, 1, &mode);
}}
static void put(void)
{{
    static const fmi2ValueReference one = 1, two = 2;
    double duty; int count, saturated;
    fmi2GetReal(c, &two, 1, &duty);
    fmi2GetInteger(c, &one, 1, &count);
    fmi2GetBoolean(c, &one, 1, &saturated);
    show(duty); show(count); show(saturated); puts("");
}}
""" + _main(
        """static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    c = fmi2Instantiate("a", fmi2CoSimulation, "{6f1c9a0e-servo}", "file:///", &callbacks, 0, 0);
    fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0);
    fmi2EnterInitializationMode(c);
    set();
    fmi2ExitInitializationMode(c);""",
        set_all,
        "set(); if (fmi2DoStep(c, t, h, 1) != fmi2OK) { return 1; }",
        "put();",
        "fmi2Terminate(c);",
        steps,
    )
    return _run(text, 2, [FMU2 / "sources/servo.c", FMU2 / "sources/law.c"], [FMU2 / "sources"], work, [])


def run_fmu3(work: Path, steps: int) -> str:
    """The outputs of ``fmu3``, as in :func:`run_fmu2`."""
    take = """
    for (int i = 0; i < 3; i++) { setpoints[i] = signal(); }
    gain = (float)signal();
    { double m = signal(); mask = m <= 0.0 ? 0 : (uint8_t)round(m); }
    hold = signal() != 0.0;"""
    text = f"""#define FMI3_FUNCTION_PREFIX Axes_
#include "fmi3Functions.h"
#include <math.h>
#include <stdlib.h>
#define STEP 0.002
{SIGNAL}
static double setpoints[3];
static float gain;
static uint8_t mask;
static bool hold;
static fmi3Instance c;
static void set(void)
{{
    static const fmi3ValueReference one = 1, two = 2, three = 3, four = 4;
    fmi3SetFloat64(c, &one, 1, setpoints, 3);
    fmi3SetFloat32(c, &two, 1, &gain, 1);
    fmi3SetUInt8(c, &three, 1, &mask, 1);
    fmi3SetBoolean(c, &four, 1, &hold, 1);
}}
static void put(void)
{{
    static const fmi3ValueReference five = 5, six = 6, seven = 7;
    double duty[3]; int64_t count; bool held;
    fmi3GetFloat64(c, &five, 1, duty, 3);
    fmi3GetInt64(c, &six, 1, &count, 1);
    fmi3GetBoolean(c, &seven, 1, &held, 1);
    show(duty[0]); show(duty[1]); show(duty[2]); show((double)count); show(held); puts("");
}}
""" + _main(
        """c = fmi3InstantiateCoSimulation("a", "{axes-1}", NULL, 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL);
    fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0);
    set();
    fmi3ExitInitializationMode(c);""",
        take,
        """bool a, b, d; double last;
        set(); if (fmi3DoStep(c, t, h, 1, &a, &b, &d, &last) != fmi3OK) { return 1; }""",
        "put();",
        "fmi3Terminate(c);",
        steps,
    )
    folders = [FMU3 / "sources", FMU3 / "sources/include"]
    options = ["-DAXES=3", "-DFMI3_FUNCTION_PREFIX=Axes_"]
    return _run(text.split("\n", 1)[1], 3, [FMU3 / "sources/all.c"], folders, work, options)


_GET_2 = {"Real": "fmi2Real", "Integer": "fmi2Integer", "Enumeration": "fmi2Integer", "Boolean": "fmi2Boolean"}


def run_any(folder: Path, work: Path, step: float, steps: int) -> str:
    """The outputs of an FMU whose functions have the prefix that the standard requires, or the importer's.

    Ports for text and binary data are not set; when the FMU reports its end, no step follows.
    """
    root = ElementTree.parse(folder / "modelDescription.xml").getroot()
    standard = int(root.attrib["fmiVersion"][0])
    fmi = f"fmi{standard}"
    listed = root.find("ModelVariables")
    assert listed is not None
    starts = {variable.attrib.get("valueReference"): variable.attrib.get("start", "") for variable in listed}
    items = {
        kind.attrib["name"]: [int(item.attrib["value"]) for item in kind.iter("Item")]
        for kind in root.findall("TypeDefinitions/*")
    }
    # function, C type, reference, size, values of its enumeration
    ports: dict[str, list[tuple[str, str, str, int, list[int]]]] = {"input": [], "output": []}
    for variable in listed:
        of = ports.get(variable.attrib.get("causality", ""))
        kind = next((child.tag for child in variable if child.tag in _GET_2), "") if standard == 2 else variable.tag
        if of is not None and kind not in ("", "String", "Binary"):
            function = {"Enumeration": "Integer" if standard == 2 else "Int64"}.get(kind, kind)
            c = _GET_2[kind] if standard == 2 else f"fmi3{function}"
            size = 1
            for dimension in variable.iter("Dimension"):
                size *= int(dimension.attrib.get("start") or starts[dimension.attrib["valueReference"]])
            typed = variable.find(kind) if standard == 2 else variable
            assert typed is not None
            values = items.get(typed.attrib.get("declaredType", ""), [])
            of.append((function, c, variable.attrib["valueReference"], size, values))
    take = keep = show = ""
    for index, (function, c, reference, size, values) in enumerate(ports["input"]):
        low, high = (repr(float(min(values))), repr(float(max(values)))) if values else _limits(c)
        clamped = f"v >= {high} ? {high} : v > {low} ? v : {low}"
        value = "v != 0.0" if function == "Boolean" else f"({c})round({clamped})" if high else "v"
        count = f", {size}" if standard == 3 else ""
        take += f"for (int i = 0; i < {size}; i++) {{ double v = signal(); in{index}[i] = {value}; }}\n"
        keep += f"{{ {fmi}ValueReference r = {reference}; {fmi}Set{function}(c, &r, 1, in{index}{count}); }}\n"
    for function, c, reference, size, _ in ports["output"]:
        count = f", {size}" if standard == 3 else ""
        show += f"{{ {fmi}ValueReference r = {reference}; {c} v[{size}]; {fmi}Get{function}(c, &r, 1, v{count});\n"
        show += f"  for (int i = 0; i < {size}; i++) {{ show((double)v[i]); }} }}\n"
    variables = "".join(f"static {c} in{index}[{size}];\n" for index, (_, c, _, size, _) in enumerate(ports["input"]))
    guid = root.attrib["guid" if standard == 2 else "instantiationToken"]
    if standard == 2:
        start = f"""static const fmi2CallbackFunctions callbacks = {{logger, calloc, free, NULL, NULL}};
    c = fmi2Instantiate("a", fmi2CoSimulation, "{guid}", "file:///", &callbacks, 0, 0);
    if (c == NULL || fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0) > fmi2Warning) {{ return 3; }}
    fmi2EnterInitializationMode(c); {keep} fmi2ExitInitializationMode(c);"""
        do = """if (!ended) {
            fmi2Status s = fmi2DoStep(c, t, h, 1);
            if (s == fmi2Discard) { s = fmi2GetBooleanStatus(c, fmi2Terminated, &ended); if (!ended) { return 1; } }
            if (s != fmi2OK) { return 1; }
        }"""
        log = "fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String g, fmi2String m, ..."
    else:
        start = f"""c = fmi3InstantiateCoSimulation("a", "{guid}", NULL, 0, 0, 0, 0, NULL, 0, NULL, logger, NULL);
    if (c == NULL) {{ return 3; }}
    fmi3EnterInitializationMode(c, 0, 0.0, 0.0, 0, 0.0); {keep} fmi3ExitInitializationMode(c);"""
        do = """if (!ended) {
            bool a, b, d; double last;
            if (fmi3DoStep(c, t, h, 1, &a, &b, &d, &last) != fmi3OK) { return 1; }
            ended = b;
        }"""
        log = "fmi3InstanceEnvironment e, fmi3Status s, fmi3String g, fmi3String m"
    text = f"""#include "{fmi}Functions.h"
#include <math.h>
#include <stdlib.h>
#define STEP {step!r}
{SIGNAL}
{variables}
static {"fmi2Component" if standard == 2 else "fmi3Instance"} c;
static int ended;
static void logger({log}) {{ }}
"""
    set_and_do = f"if (!ended) {{ {keep} }} {do}"
    text += _main(start, f"(void)signal; {take}", set_and_do, f'{show} puts("");', f"{fmi}Terminate(c);", steps)
    sources, folders, options = listed_sources(folder, root, standard)
    identifier = root.find("CoSimulation").attrib["modelIdentifier"]  # type: ignore[union-attr]
    prefix = f"{identifier}_" if identifier.isidentifier() else "direct_"
    options = ["-DFMI_COSIMULATION", f"-DFMI{standard}_FUNCTION_PREFIX={prefix}", *options]
    return _run(text, standard, sources, folders, work, options)


def _limits(c: str) -> tuple[str, str]:
    """The doubles that an integer of this type can have; empty for reals."""
    match = re.fullmatch(r"fmi3(U?)Int(\d+)", "fmi3Int32" if c == "fmi2Integer" else c)
    if match is None:
        return "", ""
    bits = int(match[2]) - (match[1] == "")
    # the largest double below the power of two, where doubles are too coarse for the integer before it
    high = float(2**bits - 1) if bits <= 53 else float(2**bits - 2 ** (bits - 53))
    return ("0.0" if match[1] else repr(-float(2**bits))), repr(high)


def listed_sources(folder: Path, root: ElementTree.Element, standard: int) -> tuple[list[Path], list[Path], list[str]]:
    """The source files, include folders and options in the FMU's own lists."""
    inside = folder / "sources"
    build = inside / "buildDescription.xml"
    if standard == 3 and build.is_file():
        configurations = ElementTree.parse(build).getroot().findall("BuildConfiguration")
        configuration = next(each for each in configurations if "platform" not in each.attrib)
        files = [inside / file.attrib["name"] for file in configuration.iter("SourceFile")]
        folders = [inside, *(inside / place.attrib["name"] for place in configuration.iter("IncludeDirectory"))]
        given = configuration.iter("PreprocessorDefinition")
        return files, folders, [f"-D{item.attrib['name']}={item.attrib.get('value', '')}" for item in given]
    listed = root.find("CoSimulation/SourceFiles")
    files = [inside / file.attrib["name"] for file in listed] if listed is not None else sorted(inside.glob("*.c"))
    below = [path for path in sorted(inside.rglob("*")) if path.is_dir()]  # some tools do not list these folders
    return files, [inside, *below], []


def _run(text: str, standard: int, sources: list[Path], folders: list[Path], work: Path, options: list[str]) -> str:
    own = work / "standard"  # searched last: an FMU's own headers go first
    own.mkdir(parents=True, exist_ok=True)
    for name, header in fmi_headers(standard).items():
        (own / name).write_text(header)
    (work / "direct.c").write_text(text, encoding="utf-8")
    flags = ["-w", "-D_DEFAULT_SOURCE", *options, *(f"-I{folder}" for folder in [*folders, own])]
    files = [work / "direct.c", *sources]
    objects = [compile_file(path, work / f"direct_{index}.o", flags, "c") for index, path in enumerate(files)]
    return run([str(link(objects, work / "direct", False))])
