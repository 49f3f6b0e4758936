# SPDX-License-Identifier: Apache-2.0
"""The forms of 20-sim's FMUs for :class:`~tests.doubles.twenty_sim.exports.Export`, and FMI 2.0's functions for them.

As in ``exports.py``, no text comes from 20-sim's templates: only the interfaces and their promises are 20-sim's.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from tests.doubles.twenty_sim.exports import Export

STATES = 2
GUID = "{look-alike}"


def as_fmu(files: dict[str, str], parameters: int) -> dict[str, str]:
    """Removes the port vectors from a C export and puts its arrays into one memory, as 4.5 does for FMUs."""
    result = {}
    for name, text in files.items():
        text = text.replace("XXDouble *u, XXDouble *y, ", "")
        text = re.sub(r"void XXCopy\w+ \(XXDouble \*[uy]\)\s*\{.*?\n\}\n", "", text, flags=re.DOTALL)
        text = re.sub(r"\tXXCopy\w+ \([uy]\);\n", "", text)
        text = re.sub(r"XXInteger xx_number_of_\w+ = \d+;\n", "", text)
        sizes = {"P": parameters, "I": STATES, "V": 8, "s": STATES, "R": STATES}
        at = 0
        for array, size in sizes.items():
            text = re.sub(rf"\nXXDouble xx_{array}\[[^;]*;", f"\nXXDouble* xx_{array} = xx_MEMORY + {at};", text)
            text = text.replace(f"extern XXDouble xx_{array}[];", f"extern XXDouble* xx_{array};")
            at += size
        text = text.replace(
            "XXDouble* xx_P = xx_MEMORY", f"XXDouble xx_MEMORY[{at} + 1];\nXXDouble* xx_P = xx_MEMORY", 1
        )
        result[name] = text
    return result


def with_instance(files: dict[str, str], step: str) -> dict[str, str]:
    """Moves the global variables of an FMU into an instance, as 20-sim does since 4.6."""
    scalars = ("start_time", "finish_time", "step_size", "time", "steps", "initialize", "major", "stop_simulation")
    macros = "".join(f"#define xx_{name} model_instance->{name}\n" for name in (*"PIVsR", *scalars))
    counts = "".join(
        f"#define xx_{name} {size}\n"
        for name, size in (("parameter_count", 4), ("initialvalue_count", 2), ("variable_count", 8), ("state_count", 2))
    )
    struct = f"""{counts}
typedef struct xx_ModelInstance
{{
\tXXDouble start_time, finish_time, step_size, time;
\tXXInteger steps;
\tXXBoolean initialize, major, stop_simulation;
\tXXDouble MEMORY[xx_parameter_count + xx_initialvalue_count + xx_variable_count + 2 * xx_state_count + 1];
\tXXDouble* P;
\tXXDouble* I;
\tXXDouble* V;
\tXXDouble* s;
\tXXDouble* R;
}} xx_ModelInstance;
{macros}"""
    result = {}
    for name, text in files.items():
        text = re.sub(r"(\n|^)(extern )?XX\w+\*? xx_\w+( = [^;]*|\[[^;]*)?;", "", text)
        text = re.sub(r"(?<=\w) \(void\)", " (xx_ModelInstance* model_instance)", text)
        text = re.sub(
            r"(XX(?:Initialize|Calculate|Terminate)Submodel) \(XXDouble t\)",
            r"\1 (xx_ModelInstance* model_instance, XXDouble t)",
            text,
        )
        text = re.sub(r"(\tXX\w+) \(\);", r"\1 (model_instance);", text)
        text = text.replace("\tXXModelInitialize (model_instance);\n", "")
        if name == "xxmodel.h":
            text = text.replace('#include "xxtypes.h"\n', f'#include "xxtypes.h"\n{struct}', 1)
        if name == "xxinteg.h":
            text = text.replace('#include "xxtypes.h"', '#include "xxtypes.h"\n#include "xxmodel.h"')
        if name == "xxfuncs.c":
            text = text.replace("xx_stop_simulation = XXTRUE", "(void) message")
        result[name] = text
    result["fmi2Functions.c"] = (
        f'#include "xxsubmod.h"\nvoid *fmi2Instantiate (xx_ModelInstance* model_instance)\n{{\n'
        f"\tmodel_instance->step_size = {step};\n\tmodel_instance->P = model_instance->MEMORY;\n\treturn 0;\n}}\n"
    )
    return result


def with_output_time(files: dict[str, str], method: str) -> dict[str, str]:
    """Integration methods that get the time of the next output, as since 4.6.3 of July 2017.

    They shorten a step that would go beyond it; the discrete method then takes no step, but advances the time.
    """
    instance = "xx_ModelInstance* model_instance"
    result = {}
    for name, text in files.items():
        text = text.replace(
            f"void XX{method}Step ({instance})", f"XXBoolean XX{method}Step ({instance}, XXDouble until)"
        )
        text = text.replace(
            f"void XXCalculateSubmodel ({instance}, XXDouble t)",
            f"XXBoolean XXCalculateSubmodel ({instance}, XXDouble t, XXDouble until)",
        )
        text = text.replace(
            f"\tXX{method}Step (model_instance);\n\tXXCalculateOutput (model_instance);\n",
            f"\tif (XX{method}Step (model_instance, until) == XXFALSE)\n\t\treturn XXFALSE;\n"
            "\tXXCalculateOutput (model_instance);\n\treturn XXTRUE;\n",
        )
        result[name] = text
    result["xxmodel.h"] = result["xxmodel.h"].replace(
        "finish_time, step_size, time;", "finish_time, step_size, time, discrete_time;\n\tXXBoolean use_finish_time;"
    )
    code = result["xxinteg.c"]
    begin = code.index("{", code.index(f"XXBoolean XX{method}Step"))
    body = code[begin:].rstrip().removesuffix("}") + "\treturn XXTRUE;\n}\n"
    if method == "Discrete":
        wait = """\tif (model_instance->discrete_time + xx_step_size > until)
\t{
\t\txx_time = until;
\t\treturn XXTRUE;
\t}
"""
        body = body.replace("xx_time += xx_step_size;", "xx_time = model_instance->discrete_time += xx_step_size;")
    else:
        wait = """\tXXDouble limit = model_instance->use_finish_time && xx_finish_time < until ? xx_finish_time : until;
\tXXDouble size = limit - xx_time < xx_step_size ? limit - xx_time : xx_step_size;
"""
        body = body.replace("xx_step_size", "size")
    line = "\tXXDouble start = xx_time;\n"
    assert line in body
    result["xxinteg.c"] = code[:begin] + body.replace(line, line + wait)
    return result


def fmi2_functions(export: Export, form: str) -> str:
    """``fmi2Functions.c``: DoStep calls the submodel until its time has reached that of the next output."""
    pointers = {"P": 0, "I": (count := len(export.parameters)), "V": count + STATES}
    pointers |= {"s": pointers["V"] + 8, "R": pointers["V"] + 8 + STATES}
    instance, own = form != "globals", form == "output time"
    self_type = "xx_ModelInstance* model_instance = (xx_ModelInstance*) c;" if instance else "(void) c;"
    argument = "model_instance" if instance else ""
    member = "model_instance->" if instance else "xx_"
    comma = ", " if instance else ""
    last = ", now + step" if own else ""
    call = f"XXCalculateSubmodel ({argument}{comma}{member}time{last})"
    make = (
        "\txx_ModelInstance* model_instance = calloc (1, sizeof (xx_ModelInstance));\n"
        f"\tif (model_instance == NULL) return NULL;\n\tmodel_instance->step_size = {export.step};\n"
        + "".join(f"\tmodel_instance->{name} = model_instance->MEMORY + {at};\n" for name, at in pointers.items())
        + "\treturn model_instance;\n"
    )
    finish = (
        f"\tif (ends) {{ {member}finish_time = end;{' model_instance->use_finish_time = XXTRUE;' if own else ''} }}\n"
    )
    start = f"\tXXModelInitialize ({argument});\n" if instance else ""
    return f"""
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include "xxsubmod.h"
#include "fmi2Functions.h"
#include "fmiGUID.h"
{"" if instance else "extern XXDouble xx_MEMORY[];"}

fmi2Component fmi2Instantiate (fmi2String name, fmi2Type type, fmi2String guid, fmi2String place,
\tconst fmi2CallbackFunctions* callbacks, fmi2Boolean visible, fmi2Boolean log)
{{
\tif (strcmp (guid, FMI_GUID) != 0) return NULL;
{make if instance else f"{chr(9)}xx_time = 0.0;{chr(10)}{chr(9)}return (fmi2Component) xx_MEMORY;{chr(10)}"}}}

fmi2Status fmi2SetupExperiment (fmi2Component c, fmi2Boolean known, fmi2Real tolerance, fmi2Real begin,
\tfmi2Boolean ends, fmi2Real end)
{{
\t{self_type}
\t{member}time = begin;
{finish}{start}\treturn fmi2OK;
}}

fmi2Status fmi2EnterInitializationMode (fmi2Component c) {{ return fmi2OK; }}

fmi2Status fmi2ExitInitializationMode (fmi2Component c)
{{
\t{self_type}
\tXXInitializeSubmodel ({argument}{comma}{member}time);
\treturn fmi2OK;
}}

fmi2Status fmi2SetReal (fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[])
{{
\t{self_type}
\tfor (size_t i = 0; i < n; i++) {member}MEMORY[vr[i]] = value[i];
\treturn fmi2OK;
}}

fmi2Status fmi2GetReal (fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[])
{{
\t{self_type}
\tfor (size_t i = 0; i < n; i++) value[i] = {member}MEMORY[vr[i]];
\treturn fmi2OK;
}}

fmi2Status fmi2DoStep (fmi2Component c, fmi2Real now, fmi2Real step, fmi2Boolean keep)
{{
\t{self_type}
\twhile ({member}time < now + step)
\t{{
\t\tif ({member}finish_time > 0.0 && {member}time > {member}finish_time) return fmi2Error;
\t\t{f"if ({call} == XXFALSE) return fmi2Error" if own else call};
\t}}
\treturn fmi2OK;
}}

fmi2Status fmi2Terminate (fmi2Component c)
{{
\t{self_type}
\tXXTerminateSubmodel ({argument}{comma}{member}time);
\treturn fmi2OK;
}}

void fmi2FreeInstance (fmi2Component c)
{{
\t{self_type}
{f"{chr(9)}free (model_instance);{chr(10)}" if instance else ""}}}
"""


def model_description(export: Export, ports: list[tuple[str, str, int]]) -> str:
    """``modelDescription.xml`` in the form of 20-sim's FMUs."""
    variables = "".join(
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" variability="continuous"'
        f"{' initial=' + chr(34) + 'calculated' + chr(34) if causality == 'output' else ''}>"
        f"<Real{' start=' + chr(34) + '0.0' + chr(34) if causality == 'input' else ''}/></ScalarVariable>\n"
        for name, causality, reference in ports
    )
    outputs = [index for index, (_, causality, _) in enumerate(ports, 1) if causality == "output"]
    variables += "".join(
        f'<ScalarVariable name="{name.replace(chr(92), ".")}" valueReference="{index}" causality="parameter" '
        f'variability="tunable"><Real start="{value}"/></ScalarVariable>\n'
        for index, (name, value, _) in enumerate(export.parameters)
    )
    unknowns = "".join(f'<Unknown index="{index}"/>' for index in outputs)
    return f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{export.name}" guid="{GUID}" generationTool="20-sim">
<CoSimulation modelIdentifier="{export.name}" canHandleVariableCommunicationStepSize="true"/>
<DefaultExperiment startTime="0.0" stopTime="{export.finish}" stepSize="{export.step}"/>
<ModelVariables>
{variables}</ModelVariables>
<ModelStructure><Outputs>{unknowns}</Outputs><InitialUnknowns>{unknowns}</InitialUnknowns></ModelStructure>
</fmiModelDescription>
"""
