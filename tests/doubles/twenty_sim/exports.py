# SPDX-License-Identifier: Apache-2.0
"""Small models in the form of 20-sim's exports, written for the tests: a PI controller with a filter and a limiter.

:class:`Export` sets the differences between tests: version, integration method, prefixes, line ends, damage.  No text
comes from 20-sim's templates; only the interface and the layout of the files are 20-sim's.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from pathlib import Path

from tests.doubles.twenty_sim.exports_fmu import (
    GUID,
    as_fmu,
    fmi2_functions,
    model_description,
    with_instance,
    with_output_time,
)

STATES = 2
PARAMETERS = (
    ("PI1\\kp", "2.5", ""),
    ("PI1\\tauI", "0.8", "s"),
    ("Filter\\tau", "5.0e-2", "s"),
    ("Limiter\\maximum", "0.95", ""),
)
PARTS = ("Initial", "Static", "Input", "Dynamic", "Output", "Final")
INPUTS = (("in", "rad"), ("position", "rad"))
OUTPUTS = (("corr", ""), ("out", ""))


@dataclass(frozen=True)
class Export:
    """One export; the defaults are a C function of 20-sim 5.1."""

    name: str = "Servo"
    version: str = "5.1.4.13773"
    method: str = "Discrete"
    step: str = "0.001"
    finish: str = "2.0"
    variable: str = "xx_"
    function: str = "XX"
    suffix: str = ""
    real: str = "double"
    inputs: tuple[tuple[str, str], ...] = INPUTS
    outputs: tuple[tuple[str, str], ...] = OUTPUTS
    parameters: tuple[tuple[str, str, str], ...] = PARAMETERS
    tokens: bool = True
    token_values: dict[str, str] = field(default_factory=dict)
    newline: str = "\n"
    encoding: str = "utf-8"
    user: str = "nobody"
    dynamic: str = ""  # added to the dynamic equations
    functions: str = ""  # added to xxfuncs.c
    declarations: str = ""  # added to xxfuncs.h
    model: str = ""  # added to xxmodel.c outside of functions
    omit: tuple[str, ...] = ()  # files that are not written
    rename: dict[str, str] = field(default_factory=dict)  # usual file name -> name that is used instead

    @property
    def old(self) -> bool:
        return self.version.startswith("4.5")

    def write(self, folder: Path) -> Path:
        """Writes a C function export into ``folder``."""
        return self._save(folder, self.c_files())

    def write_cpp(self, folder: Path) -> Path:
        """Writes a C++ class export into ``folder``."""
        return self._save(folder, replace(self, variable="m_").cpp_files())

    def write_fmu(self, folder: Path, instance: bool, describe: str = "tokens.xml") -> Path:
        """Writes the C sources of an FMU: without u and y, with one memory; since 4.6 in an ``instance``.

        ``describe`` is the file that names the ports: tokens.xml, ModelConfiguration.xml or modelDescription.xml.
        """
        files = {name: text for name, text in replace(self, tokens=False).c_files().items() if name != "xxmain.c"}
        files = as_fmu(files, len(self.parameters))
        if instance:
            files = with_instance(files, self.step)
        base = len(self.parameters) + STATES
        ports = [(name, "input", 4 + i) for i, (name, _) in enumerate(self.inputs)]
        ports += [(name, "output", i) for i, (name, _) in enumerate(self.outputs)]
        if describe == "tokens.xml":
            files[describe] = self.tokens_xml()
        elif describe == "ModelConfiguration.xml":
            variables = "".join(
                f"<modelVariable><name>{name}</name><kind>{kind}</kind><type>real</type>"
                f"<storage><name>xx_V</name><index>{index}</index></storage></modelVariable>"
                for name, kind, index in ports
            )
            files[describe] = f"<modelConfiguration><modelVariables>{variables}</modelVariables></modelConfiguration>"
        else:
            variables = "".join(
                f'<ScalarVariable name="{name}" valueReference="{base + index}" causality="{kind}">'
                "<Real/></ScalarVariable>"
                for name, kind, index in ports
            )
            text = f"<fmiModelDescription><ModelVariables>{variables}</ModelVariables></fmiModelDescription>"
            files["../modelDescription.xml"] = text
        return self._save(folder / "sources", files)

    def write_whole_fmu(self, folder: Path, form: str) -> Path:
        """Writes an FMU with the functions of FMI 2.0.

        ``form`` is "globals" (4.5), "instance" (4.6), or "output time" (since 4.6.3 of July 2017): its integration
        methods get the time of the next output and do not step over it.
        """
        files = {name: text for name, text in replace(self, tokens=False).c_files().items() if name != "xxmain.c"}
        files = as_fmu(files, len(self.parameters))
        if form != "globals":
            files = with_instance(files, self.step)
        if form == "output time":
            files = with_output_time(files, self.method)
        base = len(self.parameters) + STATES
        ports = [(name, "input", base + 4 + i) for i, (name, _) in enumerate(self.inputs)]
        ports += [(name, "output", base + i) for i, (name, _) in enumerate(self.outputs)]
        files["fmi2Functions.c"] = fmi2_functions(self, form)
        files["fmiGUID.h"] = f'#define FMI_GUID "{GUID}"\n'
        files["../modelDescription.xml"] = model_description(self, ports)
        self._save(folder / "sources", files)
        return folder

    def write_tokens(self, folder: Path) -> Path:
        """Writes only ``tokens.xml``."""
        return self._save(folder, {"tokens.xml": self.tokens_xml()})

    def _save(self, folder: Path, files: dict[str, str]) -> Path:
        for name, text in files.items():
            if name in self.omit:
                continue
            path = folder / self.rename.get(name, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text.replace("\n", self.newline).encode(self.encoding))
        return folder

    # equations ------------------------------------------------------------------------------------------------------

    def port_lines(self) -> tuple[str, str]:
        v = self.variable
        take = "".join(
            f"\t{v}V{self.suffix}[{4 + i}] = u[{i}];\t\t/* {_told(*p)} */\n" for i, p in enumerate(self.inputs)
        )
        give = "".join(
            f"\ty[{i}] = \t{v}V{self.suffix}[{i}];\t\t/* {_told(*p)} */\n" for i, p in enumerate(self.outputs)
        )
        return take, give

    def parameter_lines(self) -> str:
        array = f"{self.variable}P{self.suffix}"
        return "".join(
            f"\t{array}[{i}] = {value};\t\t/* {name} {{{unit}}} */\n"
            for i, (name, value, unit) in enumerate(self.parameters)
        )

    def equations(self) -> dict[str, str]:
        """Equations by the name of their token.  V: corr, out, 2 * kp (static), start value (initial), in, position."""
        discrete = self.method == "Discrete"
        integral = "s[0] + R[2] * step_size / P[1]" if discrete else "V[2] / P[1]"
        filtered = "s[1] + (V[2] - s[1]) * (step_size / P[2])" if discrete else "(V[2] - s[1]) / P[2]"
        texts = {
            "INITIAL_EQUATIONS": "\t/* start = PI1\\kp * 10; */\n\tV[3] = P[0] * 10.0;\n",
            "STATIC_EQUATIONS": "\t/* gain = 2 * PI1\\kp; */\n\tV[7] = 2.0 * P[0];\n",
            "INPUT_EQUATIONS": "",
            "DYNAMIC_EQUATIONS": (
                "\t/* error = in - position; */\n\tV[2] = V[4] - V[5];\n\n"
                f"\t/* integral */\n\tR[0] = {integral.replace('R[2]', 'V[2]')};\n\n"
                f"\t/* filtered */\n\tR[1] = {filtered};\n\n"
                "\t/* drive = gain * error + integral + abs (filtered); */\n"
                "\tV[6] = V[7] * V[2] + s[0] + XXAbsolute (s[1]);\n" + self.dynamic
            ),
            "OUTPUT_EQUATIONS": (
                "\t/* corr = start + time; */\n\tV[0] = V[3] + time;\n\n"
                "\t/* out = (if drive > Limiter\\maximum then Limiter\\maximum else drive end); */\n"
                "\tV[1] = ((V[6] > P[3]) ? \n\t\t/* Limiter\\maximum */\n\t\tP[3]\n"
                "\t:\n\t\t/* drive */\n\t\tV[6]\n\t);\n"
            ),
            "FINAL_EQUATIONS": "\t/* corr = -1; */\n\tV[0] = -1.0;\n",
        }
        return {token: self._named(text) for token, text in texts.items()}

    def _named(self, text: str) -> str:
        """Array and system variables with this export's prefix and suffix."""
        pieces = re.split(r"(/\*.*?\*/)", text, flags=re.DOTALL)
        for index in range(0, len(pieces), 2):
            pieces[index] = re.sub(
                r"\b([VPIsRCU](?=\[)|time|step_size|major|initialize|stop_simulation)\b",
                rf"{self.variable}\1{self.suffix}",
                pieces[index],
            )
        return "".join(pieces)

    # C function -----------------------------------------------------------------------------------------------------

    def c_files(self) -> dict[str, str]:
        v, f, x = self.variable, self.function, self.suffix
        n = " + 1" if self.old else ""
        sizes = {"P": len(self.parameters), "I": STATES, "V": 8, "s": STATES, "R": STATES}
        take, give = self.port_lines()
        equations = self.equations()
        includes = "".join(
            f'#include "{name}.h"\n' for name in ("xxmodel", "xxinteg", "xxfuncs", "xxsubmod", "motionprofiles")
        )
        vectors = "XXDouble *u, XXDouble *y, XXDouble t"
        first = "".join(
            f"\t{f}Calculate{part}{x} ();\n" for part in ("Initial", "Static", "Input", "Dynamic", "Output")
        )
        names = "".join(f'\t"{name}",\n'.replace("\\", "\\\\") for name, _ in self.inputs)
        submod = f"""{self._head("xxsubmod.c")}
#include <stdlib.h>

{includes}
XXInteger {v}number_of_inputs{x} = {len(self.inputs)};
XXInteger {v}number_of_outputs{x} = {len(self.outputs)};

/* the names of the submodel io variables
XXString {v}input_names[] = {{
{names},\tNULL
}};
*/
void {f}CopyInputsToVariables{x} (XXDouble *u)
{{
{take}
}}

void {f}CopyVariablesToOutputs{x} (XXDouble *y)
{{
{give}
}}

void {f}InitializeSubmodel{x} ({vectors})
{{
\t{v}initialize{x} = XXTRUE;
\t{v}steps{x} = 0;
\t{f}ModelInitialize{x} ();
\t{f}{self.method}Initialize{x} ();
\t{v}time{x} = t;
\t{f}CopyInputsToVariables{x} (u);
{first}\t{f}CopyVariablesToOutputs{x} (y);
\t{v}initialize{x} = XXFALSE;
}}

void {f}CalculateSubmodel{x} ({vectors})
{{
\t{v}time{x} = t;
\t{f}CopyInputsToVariables{x} (u);
\t{f}CalculateInput{x} ();
\t{f}{self.method}Step{x} ();
\t{f}CalculateOutput{x} ();
\t{f}CopyVariablesToOutputs{x} (y);
}}

void {f}TerminateSubmodel{x} ({vectors})
{{
\t{v}time{x} = t;
\t{f}CopyInputsToVariables{x} (u);
\t{f}CalculateFinal{x} ();
\t{f}CopyVariablesToOutputs{x} (y);
\t{f}{self.method}Terminate{x} ();
}}
"""
        arrays = "".join(f"XXDouble {v}{array}{x}[{size}{n}];\n" for array, size in sizes.items())
        scalars = (
            ("XXDouble", "start_time", "0.0"),
            ("XXDouble", "finish_time", self.finish),
            ("XXDouble", "step_size", self.step),
            ("XXDouble", "time", "0.0"),
            ("XXInteger", "steps", "0"),
            ("XXBoolean", "initialize", "XXTRUE"),
            ("XXBoolean", "major", "XXTRUE"),
            ("XXBoolean", "stop_simulation", "XXFALSE"),
        )
        initial = "".join(f"\t{v}I{x}[{i}] = 0.0;\t\t/* state{i}_initial */\n" for i in range(STATES))
        states = "".join(f"\t{v}s{x}[{i}] = {v}I{x}[{i}];\t\t/* state{i} */\n" for i in range(STATES))
        parts = "".join(
            f"void {f}Calculate{part}{x} (void)\n{{\n{equations[token]}{extra}}}\n\n"
            for part, token, extra in (
                ("Initial", "INITIAL_EQUATIONS", ""),
                ("Static", "STATIC_EQUATIONS", ""),
                ("Input", "INPUT_EQUATIONS", ""),
                ("Dynamic", "DYNAMIC_EQUATIONS", f"\t{v}steps{x}++;\n"),
                ("Output", "OUTPUT_EQUATIONS", ""),
                ("Final", "FINAL_EQUATIONS", ""),
            )
        )
        model = f"""{self._head("xxmodel.c")}
#include <stdlib.h>
#include <math.h>
#include "xxmodel.h"
#include "xxfuncs.h"

{"".join(f"{kind} {v}{name}{x} = {value};{chr(10)}" for kind, name, value in scalars)}
{arrays}
{self.model}
void {f}ModelInitialize{x} (void)
{{
\t/* set the parameters */
{self.parameter_lines()}
\t/* set the initial values */
{initial}
\t/* set the states */
{states}}}

{parts}"""
        model_h = f"""{self._head("xxmodel.h")}
#ifndef XX_MODEL_H
#define XX_MODEL_H
#include "xxtypes.h"
{"".join(f"extern {kind} {v}{name}{x};{chr(10)}" for kind, name, _ in scalars)}
{"".join(f"extern XXDouble {v}{array}{x}[];{chr(10)}" for array in sizes)}
void {f}ModelInitialize{x} (void);
{"".join(f"void {f}Calculate{p}{x} (void);{chr(10)}" for p in PARTS)}
#endif
"""
        submod_h = f"""{self._head("xxsubmod.h")}
#ifndef XX_SUBMOD_H
#define XX_SUBMOD_H
#include "xxmodel.h"
{"".join(f"void {f}{part}Submodel{x} ({vectors});{chr(10)}" for part in ("Initialize", "Calculate", "Terminate"))}
#endif
"""
        integ_h = f"""{self._head("xxinteg.h")}
#ifndef XX_INTEG_H
#define XX_INTEG_H
#include "xxtypes.h"
#define {self.method}_METHOD
{"".join(f"void {f}{self.method}{part}{x} (void);{chr(10)}" for part in ("Initialize", "Step", "Terminate"))}
#endif
"""
        funcs_h = f"""{self._head("xxfuncs.h")}
#ifndef XX_FUNCS_H
#define XX_FUNCS_H
#include "xxtypes.h"
extern XXBoolean {v}stop_simulation{x};
XXDouble XXAbsolute (XXDouble argument);
XXBoolean XXStopSimulation (XXString message, XXInteger id);
XXDouble XXTable (XXString name, XXDouble argument, XXInteger id);
XXDouble XXRandom (XXDouble argument);
{self.declarations}
#endif
"""
        funcs = f"""{self._head("xxfuncs.c")}
#include <stdlib.h>
#include <math.h>
#include "xxfuncs.h"
XXDouble XXAbsolute (XXDouble argument)
{{
\treturn (XXDouble) fabs (argument);
}}

XXBoolean XXStopSimulation (XXString message, XXInteger id)
{{
\t{v}stop_simulation{x} = XXTRUE;
\treturn 0;
}}

XXDouble XXTable (XXString name, XXDouble argument, XXInteger id)
{{
\treturn 0;
}}

XXDouble XXRandom (XXDouble argument)
{{
\treturn argument * ((XXDouble) rand () / (XXDouble) RAND_MAX);
}}
{self.functions}
"""
        main = f"""{self._head("xxmain.c")}
#include <stdio.h>
#include "xxsubmod.h"
int main (void)
{{
\tXXDouble u [{len(self.inputs)} + 1], y [{len(self.outputs)} + 1];
\t{f}InitializeSubmodel{x} (u, y, {v}time{x});
\tprintf ("%g", y[0]);
\treturn 0;
}}
"""
        files = {
            "xxsubmod.c": submod,
            "xxsubmod.h": submod_h,
            "xxmodel.c": model,
            "xxmodel.h": model_h,
            "xxinteg.c": self._integ(),
            "xxinteg.h": integ_h,
            "xxfuncs.c": funcs,
            "xxfuncs.h": funcs_h,
            "xxtypes.h": self._types(),
            "xxmain.c": main,
            "motionprofiles.c": self._head("motionprofiles.c"),
            "motionprofiles.h": self._head("motionprofiles.h"),
        }
        if self.tokens:
            files["tokens.xml"] = self.tokens_xml()
        return files

    def _integ(self) -> str:
        v, f, x, m = self.variable, self.function, self.suffix, self.method
        each = f"for (index = 0; index < {v}STATE_SIZE; index++)"
        s, r, q, h = f"{v}s{x}[index]", f"{v}R{x}[index]", f"{v}q{x}[index]", f"{v}step_size{x}"
        again = f"\t{v}major{x} = XXFALSE;\n\t{f}CalculateDynamic{x} ();\n"
        half, k = f"{v}time{x} = start + 0.5 * {h};\n{again}", f"{v}k{x}"
        bodies = {
            "Discrete": f"\t{each} {s} = {r};\n\t{v}time{x} += {h};\n",
            "Euler": f"\t{each} {s} = {s} + {r} * {h};\n\t{v}time{x} += {h};\n",
            "RungeKutta2": (
                f"\t{each} {q} = {s};\n\t{each} {s} = {q} + {r} * 0.5 * {h};\n\t{half}"
                f"\t{each} {s} = {q} + {r} * {h};\n\t{v}time{x} = start + {h};\n"
            ),
            "RungeKutta4": (
                f"\t{each} {{ {q} = {s}; {k}[index] = {r}; {s} = {q} + 0.5 * {h} * {r}; }}\n\t{half}"
                f"\t{each} {{ {k}[index] += 2.0 * {r}; {s} = {q} + 0.5 * {h} * {r}; }}\n{again}"
                f"\t{each} {{ {k}[index] += 2.0 * {r}; {s} = {q} + {h} * {r}; }}\n"
                f"\t{v}time{x} = start + {h};\n{again}"
                f"\t{each} {s} = {q} + {h} * ({k}[index] + {r}) / 6.0;\n"
            ),
        }
        body = bodies.get(m, bodies["Euler"])
        return f"""{self._head("xxinteg.c")}
#include <stdlib.h>
#include "xxinteg.h"
#include "xxmodel.h"

#define {v}STATE_SIZE {STATES}

static XXDouble {v}q{x}[{STATES}], {v}k{x}[{STATES}];

void {f}{m}Initialize{x} (void)
{{
\t{v}major{x} = XXTRUE;
\t{v}q{x}[0] = 0.0;
}}

void {f}{m}Terminate{x} (void)
{{
}}

void {f}{m}Step{x} (void)
{{
\tXXInteger index;
\tXXDouble start = {v}time{x};
{body}\t{v}major{x} = XXTRUE;
\t{f}CalculateDynamic{x} ();
}}
"""

    def _types(self) -> str:
        return f"""{self._head("xxtypes.h")}
#ifndef XX_TYPES_H
#define XX_TYPES_H
typedef {self.real} XXDouble;
typedef int XXInteger;
typedef char XXCharacter;
typedef char XXBoolean;
typedef const char* XXString;
typedef struct {{ XXDouble *mat; XXInteger rows; XXInteger columns; }} XXMatrix;
#define XXTRUE  1
#define XXFALSE 0
#endif
"""

    def _head(self, file: str) -> str:
        return f"""/**********************************************************
 * This file has the shape of code generated by 20-sim; it was written for EPG's tests.
 *
 *  file:  {file}
 *  subm:  {self.name}
 *  model: {self.name}
 *  user:  {self.user}
 *  build: {self.version}
 **********************************************************/
"""

    # C++ class ------------------------------------------------------------------------------------------------------

    def cpp_files(self) -> dict[str, str]:
        name, m = self.name, self.method
        take, give = self.port_lines()
        equations = self.equations()
        parts = ("Initial", "Static", "Input", "Dynamic", "Output", "Final")
        arrays = {"C": 0, "P": len(self.parameters), "I": STATES, "V": 8, "s": STATES, "R": STATES}
        makes = "".join(f"\tm_{array} = new XXDouble[{size} + 1];\n" for array, size in arrays.items())
        clears = "".join(
            f"\tmemset(m_{array}, 0, ({size} + 1) * sizeof(XXDouble));\n" for array, size in arrays.items()
        )
        frees = "".join(f"\tdelete[] m_{array};\n" for array in arrays)
        initial = "".join(f"\tm_I[{i}] = 0.0;\t\t/* state{i}_initial */\n" for i in range(STATES))
        states = "".join(f"\tm_s[{i}] = m_I[{i}];\t\t/* state{i} */\n" for i in range(STATES))
        calculates = "".join(
            f"void {name}::Calculate{part} (void)\n{{\n{equations[part.upper() + '_EQUATIONS']}}}\n\n" for part in parts
        )
        source = f"""{self._head(f"{name}.cpp")}
#include <stdio.h>
#include <math.h>
#include <string.h>
#include "{name}.h"

const XXDouble c_delta = 1.0e-7;

void {name}::CopyInputsToVariables (XXDouble *u)
{{
{take}}}

void {name}::CopyVariablesToOutputs (XXDouble *y)
{{
{give}}}

{name}::{name}(void)
{{
\tm_number_parameters = {len(self.parameters)};
\tm_number_states = {STATES};
{makes}
\tReset(0.0);
\tm_finish_time = {self.finish};
}}

void {name}::Reset(XXDouble starttime)
{{
\tm_start_time = starttime;
\tm_step_size = {self.step};
\tm_time = starttime;
\tm_major = true;
\tm_stop_run = false;
{clears}
\tstate = initialrun;
}}

bool {name}::IsFinished(void)
{{
\treturn (state == finished);
}}

{name}::~{name}(void)
{{
{frees}}}

void {name}::Initialize (XXDouble *u, XXDouble *y, XXDouble t)
{{
\tm_initialize = true;
\tm_stop_run = false;
{self.parameter_lines()}
{initial}
{states}
\tmyintegmethod.Initialize(this);
\tm_time = t;
\tCopyInputsToVariables (u);
\tCalculateInitial ();
\tCalculateStatic ();
\tCalculateInput ();
\tCalculateDynamic ();
\tCalculateOutput ();
\tCopyVariablesToOutputs (y);
\tm_initialize = false;
\tstate = mainrun;
}}

void {name}::Calculate (XXDouble *u, XXDouble *y)
{{
\tswitch (state)
\t{{
\t\tcase initialrun:
\t\t\tInitialize(u, y, 0.0);
\t\t\tbreak;
\t\tcase mainrun:
\t\t\tif ((m_time <= (m_finish_time - m_step_size + c_delta)) || (m_finish_time == 0.0))
\t\t\t{{
\t\t\t\tCalculateStatic ();
\t\t\t\tCopyInputsToVariables (u);
\t\t\t\tCalculateInput ();
\t\t\t\tmyintegmethod.Step();
\t\t\t\tCalculateOutput ();
\t\t\t\tCopyVariablesToOutputs (y);
\t\t\t}}
\t\t\telse
\t\t\t{{
\t\t\t\tstate = finished;
\t\t\t}}
\t\t\tif (m_stop_run == true)
\t\t\t{{
\t\t\t\tstate = finished;
\t\t\t}}
\t\t\tbreak;
\t\tdefault:
\t\t\tbreak;
\t}}
}}

void {name}::Terminate (XXDouble *u, XXDouble *y)
{{
\tCopyInputsToVariables (u);
\tCalculateFinal ();
\tCopyVariablesToOutputs (y);
}}

{calculates}
bool {name}::SetFinishTime(XXDouble newtime)
{{
\tif ((newtime <= 0.0) || (newtime > m_time))
\t{{
\t\tm_finish_time = newtime;
\t\treturn true;
\t}}
\treturn false;
}}

XXBoolean {name}::XXStopSimulation (XXString message, XXInteger id)
{{
\tm_stop_run = true;
\treturn 0;
}}
{self.model}
"""
        declared = "".join(f"\t\tvoid Calculate{part} (void);\n" for part in parts if part != "Dynamic")
        header = f"""{self._head(f"{name}.h")}
#ifndef {name}_H
#define {name}_H
#include "common/xxfuncs.h"
#include "common/xxmodel.h"
#include "common/xxinteg.h"
class {name}: virtual public Submodel20sim
{{
\tpublic:
\t\tenum stateflags_{name} {{initialrun, mainrun, finished}};
\t\t{name}(void);
\t\tvirtual ~{name}(void);
\t\tvoid Initialize (XXDouble *u, XXDouble *y, XXDouble t);
\t\tvoid Calculate (XXDouble *u, XXDouble *y /*, XXDouble t*/ );
\t\tvoid Terminate (XXDouble *u, XXDouble *y);
\t\tbool SetFinishTime(XXDouble newtime);
\t\tbool IsFinished(void);
\t\tvoid Reset(XXDouble starttime);
\t\tstateflags_{name} state;
\tprotected:
\t\tvoid CalculateDynamic (void);
\tprivate:
{declared}\t\tvoid CopyInputsToVariables (XXDouble *u);
\t\tvoid CopyVariablesToOutputs (XXDouble *y);
\t\tXXBoolean XXStopSimulation (XXString message, XXInteger id);
\t\t{m} myintegmethod;
}};
#endif
"""
        base = f"""{self._head("xxmodel.h")}
#ifndef SUBMODEL20SIM_H
#define SUBMODEL20SIM_H
#include "xxtypes.h"
class Submodel20sim
{{
\tprotected:
\t\tfriend class {m};
\t\tvirtual void CalculateDynamic (void) {{}};
\t\tbool m_initialize;
\t\tbool m_major;
\t\tbool m_stop_run;
\t\tXXDouble m_step_size;
\t\tXXDouble m_start_time;
\t\tXXDouble m_finish_time;
\t\tXXDouble m_time;
\tpublic:
\t\tvirtual ~Submodel20sim(){{}};
\t\tXXDouble GetStepSize(void) {{ return m_time; }};
\t\tint m_number_parameters;
\t\tint m_number_states;
\t\tXXDouble *m_C, *m_P, *m_I, *m_V, *m_s, *m_R;
}};
#endif
"""
        steps = {
            "Discrete": "model->m_s[index] = model->m_R[index];",
            "Euler": "model->m_s[index] += model->m_R[index] * model->m_step_size;",
        }
        integ_h = f"""{self._head("xxinteg.h")}
#ifndef XX_INTEG_H
#define XX_INTEG_H
#include "xxtypes.h"
class Submodel20sim;
class {m}
{{
  public:
\t{m}(void): model(NULL) {{}}
\tvoid Initialize(Submodel20sim* themodel);
\tvoid Step();
  protected:
\tSubmodel20sim* model;
}};
#endif
"""
        integ = f"""{self._head("xxinteg.cpp")}
#include <stdlib.h>
#include "xxinteg.h"
#include "xxmodel.h"
void {m}::Initialize (Submodel20sim* themodel)
{{
\tmodel = themodel;
\tmodel->m_major = true;
}}
void {m}::Step ()
{{
\tXXInteger index;
\tfor (index = 0; index < model->m_number_states; index++)
\t{{
\t\t{steps.get(m, steps["Euler"])}
\t}}
\tmodel->m_time += model->m_step_size;
\tmodel->CalculateDynamic ();
}}
"""
        plain = replace(self, variable="xx_", function="XX").c_files()
        funcs = re.sub(r"XXBoolean XXStopSimulation[^{]*\{.*?\n\}\n", "", plain["xxfuncs.c"], flags=re.DOTALL)
        funcs_h = re.sub(r"extern XXBoolean[^\n]*\n|XXBoolean XXStopSimulation[^\n]*\n", "", plain["xxfuncs.h"])
        files = {
            f"{name}.cpp": source,
            f"{name}.h": header,
            f"test_{name}.cpp": f'#include "{name}.h"\nint main(void) {{ {name} model; return 0; }}\n',
            "common/xxmodel.h": base,
            "common/xxinteg.h": integ_h,
            "common/xxinteg.cpp": integ,
            "common/xxfuncs.h": funcs_h,
            "common/xxfuncs.cpp": funcs,
            "common/xxtypes.h": self._types(),
        }
        if self.tokens:
            files[f"{name}_tokens.xml"] = self.tokens_xml()
        return files

    # tokens ---------------------------------------------------------------------------------------------------------

    def tokens_xml(self) -> str:
        take, give = self.port_lines()
        v, x = self.variable, self.suffix
        tokens = {
            "SUBMODEL_NAME": self.name,
            "GENERATION_BUILD": self.version,
            "INTEGRATION_METHOD_NAME": self.method,
            "TIME_STEP_SIZE": self.step,
            "START_TIME": "0.0",
            "FINISH_TIME": self.finish,
            "VARPREFIX": v,
            "FUNCTIONPREFIX": self.function,
            "XX_TIME": "time",
            "XX_INITIALIZE": "initialize",
            "XX_VARIABLE_ARRAY_NAME": "V",
            "XX_PARAMETER_ARRAY_NAME": "P",
            "XX_INITIAL_VALUE_ARRAY_NAME": "I",
            "XX_STATE_ARRAY_NAME": "s",
            "XX_RATE_ARRAY_NAME": "R",
            "NUMBER_INPUTS": str(len(self.inputs)),
            "NUMBER_OUTPUTS": str(len(self.outputs)),
            "NUMBER_PARAMETERS": str(len(self.parameters)),
            "NUMBER_INITIAL_VALUES": str(STATES),
            "NUMBER_VARIABLES": "8",
            "NUMBER_STATES": str(STATES),
            "NUMBER_CONSTANTS": "0",
            "NUMBER_DEPSTATES": "0",
            "NUMBER_ALGLOOPS": "0",
            "NUMBER_CONSTRAINTS": "0",
            "INPUT_NAMES3": "".join(f"{name}\n" for name, _ in self.inputs),
            "OUTPUT_NAMES3": "".join(f"{name}\n" for name, _ in self.outputs),
            "PARAMETER_NAMES3": "".join(f"{name}\n" for name, _, _ in self.parameters),
            "PARAMETER_UNITS": "".join(f"{unit}\n" for _, _, unit in self.parameters),
            "INPUT_TO_VARIABLE_EQUATIONS": take,
            "VARIABLE_TO_OUTPUT_EQUATIONS": give,
            "INITIALIZE_CONSTANTS": "",
            "INITIALIZE_PARAMETERS": self.parameter_lines(),
            "INITIALIZE_INITIAL_VALUES": "".join(f"\t{v}I{x}[{i}] = 0.0;\n" for i in range(STATES)),
            "INITIALIZE_STATES": "".join(f"\t{v}s{x}[{i}] = {v}I{x}[{i}];\n" for i in range(STATES)),
            **self.equations(),
            **self.token_values,
        }
        lines = [
            f'\t<token name="{name}"><![CDATA[{value}]]></token>\n' for name, value in tokens.items() if value != "-"
        ]
        return '<?xml version="1.0" encoding="UTF-8"?>\n<tokens>\n' + "".join(lines) + "</tokens>\n"


def _told(name: str, unit: str) -> str:
    return f"{name} {{{unit}}}" if unit else name
