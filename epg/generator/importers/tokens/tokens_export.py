# SPDX-License-Identifier: Apache-2.0
"""The C code of a model whose export has tokens, but no C files.

The equations stay as 20-sim writes them, except for the names of arrays and system variables: these become members of
the model's instance.

The helper functions are EPG's own.  They follow the definitions of the SIDOPS+ language.  For arguments in range, their
results are equal, bit for bit, to those of the functions in 20-sim's C templates.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.documents.source_file import SourceFile
from epg.generator.emit.text import Code, double
from epg.generator.models.assignments import assignments, exact_number
from epg.generator.models.code import ModelBuild, ModelCode, ModelLibrary, Render
from epg.generator.models.features import rounded_in
from epg.generator.models.model import Model
from epg.generator.models.tokens import Tokens

_SCALARS = {
    "step_size": "step_size",
    "start_time": "start_time",
    "finish_time": "finish_time",
    "steps": "steps",
    "major": "major",
    "stop_simulation": "stop",
    "stop_run": "stop",
}

EQUATIONS = (
    "INITIAL_EQUATIONS",
    "STATIC_EQUATIONS",
    "INPUT_EQUATIONS",
    "DYNAMIC_EQUATIONS",
    "OUTPUT_EQUATIONS",
    "FINAL_EQUATIONS",
)
CODE = (
    "INITIALIZE_CONSTANTS",
    "INITIALIZE_PARAMETERS",
    "INITIALIZE_INITIAL_VALUES",
    "INITIALIZE_STATES",
    "INPUT_TO_VARIABLE_EQUATIONS",
    "VARIABLE_TO_OUTPUT_EQUATIONS",
    *EQUATIONS,
)
#: arrays, by the token with their name: the default name, the member of the instance in C, the token with their size
ARRAYS = {
    "XX_VARIABLE_ARRAY_NAME": ("V", "variables", "NUMBER_VARIABLES"),
    "XX_PARAMETER_ARRAY_NAME": ("P", "parameters", "NUMBER_PARAMETERS"),
    "XX_INITIAL_VALUE_ARRAY_NAME": ("I", "initial_values", "NUMBER_INITIAL_VALUES"),
    "XX_CONSTANT_ARRAY_NAME": ("C", "constants", "NUMBER_CONSTANTS"),
    "XX_STATE_ARRAY_NAME": ("s", "states", "NUMBER_STATES"),
    "XX_RATE_ARRAY_NAME": ("R", "rates", "NUMBER_STATES"),
    "XX_UNNAMED_ARRAY_NAME": ("U", "unnamed", "NUMBER_UNNAMED"),
    "XX_FAVORITE_PARS_ARRAY_NAME": ("F", "favorite_parameters", "NUMBER_FAVORITE_PARAMETERS"),
    "XX_FAVORITE_VARS_ARRAY_NAME": ("f", "favorite_variables", "NUMBER_FAVORITE_VARIABLES"),
}


@dataclass(frozen=True)
class TokensExport(ModelCode):
    """A ``tokens.xml`` without exported C or C++ files."""

    tokens: Tokens
    functions: tuple[str, ...]  # the helper functions that the equations call, without prefix: "Absolute", "Sign", ...
    templates = Path(__file__).parent
    writes_every_output = True
    derives = True

    def files(self, library: ModelLibrary, render: Render) -> dict[str, str]:
        variables = _variables(library.model, self, library.values) | {"helpers": _helper_texts(self.functions)}
        return {f"{library.name}_export.c": render("tokens.c.j2", **variables)}

    def build(self, library: ModelLibrary, frame: ModelBuild) -> ModelBuild:
        return frame

    def rounded(self, model: Model) -> frozenset[str]:
        return model.rounded | rounded_in(" ".join(_helper_texts(self.functions)))

    def with_step(self, model: Model, step: Fraction) -> Model | None:
        """An integration method takes any step."""
        return None if model.method == "Discrete" else replace(model, step=step)


def _variables(model: Model, details: TokensExport, values: Mapping[str, float]) -> dict[str, Any]:
    """The template variables of ``tokens.c.j2``: blocks of code, sizes of arrays, times.

    ``values`` holds new values of parameters by the names of 20-sim.
    """
    tokens = details.tokens
    names = _names(tokens, details.functions)
    blocks = {token: Code(_block(tokens, token, names, model, values)) for token in CODE}
    counts = {member: tokens.count(count) for _, member, count in ARRAYS.values()}
    counts["delays"] = tokens.count("NUMBEROF_DELAYFUNCTION")
    counts["initials"] = tokens.count("NUMBEROF_INITIALFUNCTION")
    start = exact_number(tokens.trimmed("START_TIME")) or Fraction(0)
    finish = exact_number(tokens.trimmed("FINISH_TIME")) or Fraction(0)
    # Up to version 4.5, 20-sim added the four slopes of Runge Kutta 4 in another order, which rounds differently.
    old = re.match(r"4\.[0-5]\b", model.version) is not None
    return {
        "code": blocks,
        "e": SimpleNamespace(counts=counts, start_time=start, finish_time=finish, old_runge_kutta=old),
    }


def _names(tokens: Tokens, functions: Sequence[str]) -> dict[str, str]:
    """The identifiers in the equations, with the C that replaces each."""
    prefix = tokens.trimmed("VARPREFIX")
    names = {}
    for token, (default, member, _) in ARRAYS.items():
        names[prefix + (tokens.trimmed(token) or default)] = f"self->{member}"
    for word, member in _SCALARS.items():
        names[prefix + word] = f"self->{member}"
    names[prefix + (tokens.trimmed("XX_TIME") or "time")] = "self->time"
    names[prefix + (tokens.trimmed("XX_INITIALIZE") or "initialize")] = "self->initialize"
    names["XXTRUE"], names["XXFALSE"] = "1", "0"
    names["XXDouble"], names["XXInteger"], names["XXBoolean"] = "double", "int", "char"
    function_prefix = tokens.trimmed("FUNCTIONPREFIX") or "XX"
    for function in functions:
        for before in {function_prefix, "XX"}:
            names[before + function] = _helper_name(function)
    return names


def _block(tokens: Tokens, token: str, names: Mapping[str, str], model: Model, values: Mapping[str, float]) -> str:
    """The C code of one token, indented as the body of a function, with the new values of parameters."""
    text = tokens.code(token).text
    if token == "INITIALIZE_PARAMETERS":
        text = _with_values(tokens.code(token), model, values)
    pieces = re.split(r"(/\*.*?\*/|//[^\n]*)", text, flags=re.DOTALL)
    for position, piece in enumerate(pieces):
        if position % 2 == 0:
            piece = re.sub(r"(?<![\w.>])[A-Za-z_]\w*", lambda match: names.get(match[0], match[0]), piece)
            for function in ("delay", "initial_value", "stop_simulation", "random"):
                piece = re.sub(rf"\bsidops_{function}\s*\(\s*", f"sidops_{function}(self, ", piece)
            pieces[position] = piece
    lines = [line.rstrip().expandtabs(4) for line in "".join(pieces).strip("\n").split("\n")]
    while lines and not lines[0].strip():
        lines.pop(0)
    if lines:
        lines[0] = "    " + lines[0].strip()
    return "\n".join(lines)


def _with_values(file: SourceFile, model: Model, values: Mapping[str, float]) -> str:
    """The code that sets the parameters, with their new values."""
    text = file.text
    by_index = {parameter.index: parameter for parameter in model.parameters}
    for line in reversed(list(assignments(file))):
        parameter = by_index.get(line.index)
        if parameter is not None and parameter.name in values:
            text = text[: line.value_start] + str(double(values[parameter.name])) + text[line.value_end :]
        elif parameter is None:
            # A parameter that is a string.  A double cannot hold it, and does not need to: only dll() functions
            # read strings, and EPG refuses models that use them.
            text = text[: line.value_start] + "0.0" + text[line.value_end :]
    return text


def _helper_name(function: str) -> str:
    return "sidops_" + re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", function).lower()


def _helper_texts(functions: Sequence[str]) -> list[str]:
    """The C definitions of the helper functions ``functions``, in alphabetical order."""
    return [_HELPERS[function].strip("\n") for function in sorted(functions)]


def _simple(function: str, expression: str, arguments: str = "double x") -> str:
    return f"static double {_helper_name(function)}({arguments})\n{{\n    return {expression};\n}}"


def _bits(function: str, expression: str, arguments: str = "int a, int b") -> str:
    return f"static int {_helper_name(function)}({arguments})\n{{\n    return {expression};\n}}"


_SHIFT = "bits > 0 ? (int)((unsigned)value {up} bits) : value {down} -bits"

_HELPERS: dict[str, str] = {
    "Absolute": _simple("Absolute", "fabs(x)"),
    "ArcCosineHyperbolic": _simple("ArcCosineHyperbolic", "log(x + sqrt(x * x - 1.0))"),
    "ArcSineHyperbolic": _simple("ArcSineHyperbolic", "log(x + sqrt(x * x + 1.0))"),
    "ArcTangentHyperbolic": _simple("ArcTangentHyperbolic", "0.5 * log((1.0 + x) / (1.0 - x))"),
    "Exponent2": _simple("Exponent2", "exp(x * 0.6931471805599453)"),
    "Exponent10": _simple("Exponent10", "exp(x * 2.3025850929940457)"),
    "Logarithm2": _simple("Logarithm2", "log(x) * 1.4426950408889634"),
    "Logarithm10": _simple("Logarithm10", "log10(x)"),
    "Pow2": _simple("Pow2", "x * x"),
    "Power": _simple("Power", "pow(x, exponent)", "double x, double exponent"),
    "IntegerDivide": _simple("IntegerDivide", "(double)(int)(a / b)", "double a, double b"),
    "IntegerModulo": _simple("IntegerModulo", "a - (int)(a / b) * b", "double a, double b"),
    "Ramp": _simple("Ramp", "time < start ? 0.0 : time - start", "double start, double time"),
    "Step": _simple("Step", "time < start ? 0.0 : 1.0", "double start, double time"),
    "Sign": _simple("Sign", "x < 0.0 ? -1.0 : (x == 0.0 ? 0.0 : 1.0)"),
    "Xor": _simple("Xor", "(a != 0.0) != (b != 0.0)", "double a, double b"),
    "Impulse": """
static double sidops_impulse(double start, double duration, double time, double step)
{
    if (step <= 0.0 || duration <= 0.0 || time < start || time > start + duration) {
        return 0.0;
    }
    return step < duration ? 1.0 / duration : 1.0 / step;
}
""",
    "Round": """
/* Rounds to the nearest whole number, and halves away from zero. */
static double sidops_round(double x)
{
    if (fabs(x - (int)x) < 0.5) {
        return (double)(int)x;
    }
    return x >= 0.0 ? ceil(x) : floor(x);
}
""",
    "Random": """
/*
 * Returns a uniformly distributed number between -range and range: 31 bits of a xorshift generator (G. Marsaglia,
 * J. Stat. Software 8(14), 2003).
 */
static double sidops_random(model_t *self, double range)
{
    uint32_t x = self->random_state;
    x ^= x << 13;
    x ^= x >> 17;
    x ^= x << 5;
    self->random_state = x;
    return range * 2.0 * ((double)(x >> 1) / 2147483647.0 - 0.5);
}
""",
    "Delay": """
/* Returns the value of `x` one step ago; in the first step `initial`. */
static double sidops_delay(model_t *self, double x, double initial, int id)
{
    const double value = self->initialize ? initial : self->delayed[id];

    if (self->major) {
        self->delay_inputs[id] = x;
    }
    return value;
}
""",
    "InitialValue": """
/* Returns the value of `x` at the start. */
static double sidops_initial_value(model_t *self, double x, int id)
{
    if (self->initialize) {
        self->first_values[id] = x;
    }
    return self->first_values[id];
}
""",
    "StopSimulation": """
static int sidops_stop_simulation(model_t *self, const char *message, int id)
{
    (void)message;
    (void)id;
    self->stop = true;
    return 0;
}
""",
    "Warning": """
static int sidops_warning(const char *message, int id)
{
    (void)message;
    (void)id;
    return 0;
}
""",
    "BitAnd": _bits("BitAnd", "a & b"),
    "BitOr": _bits("BitOr", "a | b"),
    "BitXor": _bits("BitXor", "a ^ b"),
    "BitInv": _bits("BitInv", "~a", "int a"),
    "BitCmp": _bits("BitCmp", "bits < 32 ? ~a & (int)((1u << bits) - 1u) : ~a", "int a, int bits"),
    "BitGet": _bits("BitGet", "(a >> (position - 1)) & 1", "int a, int position"),
    "BitSet": _bits("BitSet", "a | (int)(1u << (position - 1))", "int a, int position"),
    "BitClear": _bits("BitClear", "a & ~(int)(1u << (position - 1))", "int a, int position"),
    "BitShift": _bits("BitShift", _SHIFT.format(up="<<", down=">>"), "int value, int bits"),
    "BitShiftRight": _bits(
        "BitShiftRight", "bits > 0 ? value >> bits : (int)((unsigned)value << -bits)", "int value, int bits"
    ),
    "SwapBytes": """
static int sidops_swap_bytes(int value)
{
    const uint32_t x = (uint32_t)value;
    return (int)(x << 24 | (x & 0xFF00u) << 8 | (x >> 8 & 0xFF00u) | x >> 24);
}
""",
}
