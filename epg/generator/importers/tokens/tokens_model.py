# SPDX-License-Identifier: Apache-2.0
"""Imports a ``tokens.xml`` without exported C files.

It contains all equations of the model.  EPG's own template makes C code of them.
"""

from __future__ import annotations

import re

from epg.generator.diagnostics import Diagnostics, Note, did_you_mean
from epg.generator.documents.text_file import one_line
from epg.generator.importers.tokens.tokens_export import ARRAYS, CODE, TokensExport
from epg.generator.models.assignments import assignments, exact_number, is_step, port_lines
from epg.generator.models.c_code import KEYWORDS
from epg.generator.models.features import STUBS, check_method, check_tokens, rounded_in
from epg.generator.models.identifiers import words
from epg.generator.models.model import Model
from epg.generator.models.ports import check_identifiers, make_parameters, make_ports
from epg.generator.models.tokens import Tokens
from epg.generator.source import Span

#: tokens whose values the C code around the equations depends on
NEEDED = """TIME_STEP_SIZE INTEGRATION_METHOD_NAME VARPREFIX NUMBER_INPUTS NUMBER_OUTPUTS NUMBER_PARAMETERS
NUMBER_INITIAL_VALUES NUMBER_VARIABLES NUMBER_STATES""".split()

#: functions of <math.h> that equations can call directly
MATH = words("acos asin atan atan2 ceil cos cosh exp fabs floor fmod log log10 pow sin sinh sqrt tan tanh")

#: helper functions that EPG's template provides, by their names without prefix
HELPERS = words("""
    Absolute ArcCosineHyperbolic ArcSineHyperbolic ArcTangentHyperbolic BitAnd BitClear BitCmp BitGet BitInv
    BitOr BitSet BitShift BitShiftRight BitXor Delay Exponent10 Exponent2 Impulse InitialValue IntegerDivide
    IntegerModulo Logarithm10 Logarithm2 Pow2 Power Ramp Random Round Sign Step StopSimulation SwapBytes Warning
    Xor
""")

_EXPORT_HINT = "export the model with the C function or the C++ class target, and use its sources"


def load_tokens_model(tokens: Tokens, diagnostics: Diagnostics) -> Model | None:
    """The model in ``tokens``.  None if it cannot be used; the reasons are reported."""
    before = diagnostics.error_count
    whole = tokens.span("SUBMODEL_NAME")
    if not _is_complete(tokens, diagnostics):
        return None
    check_tokens(tokens, diagnostics)
    check_method(tokens.trimmed("INTEGRATION_METHOD_NAME"), tokens.span("INTEGRATION_METHOD_NAME"), diagnostics)
    helpers = _check_calls(tokens, diagnostics)
    _check_types(tokens, diagnostics)
    step = exact_number(tokens.trimmed("TIME_STEP_SIZE"))
    if not is_step(step):
        message = f"the step size '{tokens.trimmed('TIME_STEP_SIZE')[:80]}' is not a positive number"
        diagnostics.error("model-step", tokens.span("TIME_STEP_SIZE"), message, hint="export the model again")
    ports = []
    for kind, token, vector in (
        ("input", "INPUT_TO_VARIABLE_EQUATIONS", "u"),
        ("output", "VARIABLE_TO_OUTPUT_EQUATIONS", "y"),
    ):
        names = tokens.named(kind.upper())
        count = tokens.count(f"NUMBER_{kind.upper()}S")
        lines = port_lines(tokens.code(token), kind, vector)
        group = make_ports(lines, kind, names, None, diagnostics, tokens.span(token), count)
        check_identifiers(group, diagnostics)
        ports.append(group)
    if diagnostics.error_count > before or step is None:
        return None
    array = tokens.trimmed("VARPREFIX") + (tokens.trimmed("XX_PARAMETER_ARRAY_NAME") or "P")
    lines_of_parameters = [line for line in assignments(tokens.code("INITIALIZE_PARAMETERS")) if line.array == array]
    names_of_parameters = tokens.names("PARAMETER")
    units = tokens.units("PARAMETER", len(names_of_parameters))
    parameters, _ = make_parameters(lines_of_parameters, names_of_parameters, units)
    return Model(
        name=one_line(tokens.trimmed("SUBMODEL_NAME") or tokens.trimmed("MODEL_NAME") or tokens.path.parent.name),
        origin="20-sim tokens",
        language="c",
        version=one_line(tokens.trimmed("GENERATION_BUILD")),
        method=tokens.trimmed("INTEGRATION_METHOD_NAME"),
        step=step,
        inputs=ports[0],
        outputs=ports[1],
        parameters=parameters,
        rounded=rounded_in(" ".join(tokens.code(token).code for token in CODE)),
        directory=tokens.path.parent,
        files=(tokens.path,),
        span=whole,
        code=TokensExport(tokens, helpers),
    )


def _check_types(tokens: Tokens, diagnostics: Diagnostics) -> None:
    """Reports matrices, and warns of single precision."""
    if tokens.count("NUMBER_MATRICES"):
        message = "the model uses matrices, which EPG does not support in tokens"
        diagnostics.error("model-tokens", tokens.span("NUMBER_MATRICES"), message, hint=_EXPORT_HINT)
    if tokens.trimmed("FLOATPOSTFIX") in ("f", "F"):
        message = "the tokens were made for single precision"
        diagnostics.warning("model-single-precision", tokens.span("FLOATPOSTFIX"), message, hint=_EXPORT_HINT)


def _is_complete(tokens: Tokens, diagnostics: Diagnostics) -> bool:
    """True if no token is missing and no equation uses an element beyond the end of its array.

    All missing tokens are reported by one error.
    """
    missing = [name for name in (*CODE, *NEEDED) if name not in tokens.values]
    if missing:
        span = Span(str(tokens.path), 1, 1, 2)
        named = ", ".join(f"'{name}'" for name in missing[:6])
        more = f" and {len(missing) - 6} more" if len(missing) > 6 else ""
        word = "tokens are missing" if missing[1:] else "a token is missing"
        message = f"'{tokens.path.name}' alone is not a model, because {word}: {named}{more}"
        diagnostics.error("model-tokens", span, message, hint="export the model again")
        return False
    return _fits(tokens, diagnostics)


def _fits(tokens: Tokens, diagnostics: Diagnostics) -> bool:
    """True if no equation uses an element beyond the end of its array.  Reports the first one of each array."""
    before = diagnostics.error_count
    prefix = tokens.trimmed("VARPREFIX")
    for token, (default, _, count) in ARRAYS.items():
        array = prefix + (tokens.trimmed(token) or default)
        element = re.compile(rf"(?<![\w.]){re.escape(array)}\s{{0,80}}\[\s{{0,80}}(\d{{1,12}})\s{{0,80}}\]", re.ASCII)
        for name in CODE:
            file = tokens.code(name)
            beyond = next((m for m in element.finditer(file.code) if int(m[1]) >= tokens.count(count)), None)
            if beyond is not None:
                message = f"the equations use {beyond[0]}, but '{count}' is {tokens.count(count)}"
                note = Note("the count", tokens.span(count))
                span = file.span(beyond.start(), beyond.end())
                hint = "export the model again, or undo the changes in its tokens"
                diagnostics.error("model-tokens", span, message, hint=hint, notes=[note])
                break
    return diagnostics.error_count == before


def _balanced(code: str) -> bool:
    """True if the braces of a token are balanced, so that its code cannot end the function into which it is written."""
    depth = 0
    for brace in re.findall(r"[{}]", code):
        depth += 1 if brace == "{" else -1
        if depth < 0:
            return False
    return depth == 0


def _comments_closed(text: str) -> bool:
    """True if each comment in a token ends in it, so that the code behind the token does not become a comment."""
    last_line = text[text.rfind("\n") + 1 :]
    return all(match[1] for match in re.finditer(r"/\*.*?(\*/|\Z)", text, re.DOTALL)) and "//" not in last_line


def _check_calls(tokens: Tokens, diagnostics: Diagnostics) -> tuple[str, ...]:
    """The helper functions that the equations call.  Reports stubs, clocks, ``dll()`` and unknown functions."""
    prefix = tokens.trimmed("FUNCTIONPREFIX") or "XX"
    helpers: set[str] = set()
    judged = {*KEYWORDS, *MATH}
    for token in CODE:
        file = tokens.code(token)
        if "#" in file.without_comments or not _balanced(file.code) or not _comments_closed(file.text):
            message = f"token '{token}' must have only equations"
            diagnostics.error("model-tokens", tokens.span(token), message, hint="export the model again")
            continue
        for match in re.finditer(r"(?<![\w>.])([A-Za-z_]\w*)\s*\(", file.code):
            name = match[1]
            if name in judged:
                continue
            judged.add(name)
            bare = re.sub(rf"^(?:{re.escape(prefix)}|XX)", "", name)
            span = file.span(match.start(1), match.end(1))
            if bare != name and bare in HELPERS:
                helpers.add(bare)
            else:
                _check_call(name, bare, span, diagnostics)
    if "Random" in helpers:
        message = "the model uses random numbers: they are the same after each start, and differ from those of 20-sim"
        hint = "use an input port for the noise"
        diagnostics.warning("model-random", tokens.span("SUBMODEL_NAME"), message, hint=hint)
    return tuple(sorted(helpers))


def _check_call(name: str, bare: str, span: Span, diagnostics: Diagnostics) -> None:
    """Reports a call of the function ``name``, which is ``bare`` without the prefix of 20-sim's functions."""
    if bare != name and bare in STUBS:
        message = f"the model uses {STUBS[bare]}, which is empty in exports"
        diagnostics.error("model-stub", span, message, hint=f"avoid {STUBS[bare]} in the model")
    elif bare == "RealTime":
        message = "the model reads the computer's clock, which targets do not have"
        diagnostics.error("model-real-time", span, message, hint="use 'time' instead of 'realtime' in 20-sim")
    elif bare == "String2Double":
        return
    elif bare != name:
        message = f"EPG does not support the function '{name}' in tokens"
        diagnostics.error("model-tokens", span, message, hint=did_you_mean(bare, HELPERS) or _EXPORT_HINT)
    else:
        message = f"'{name}' is called, but it is not part of the export: dll() functions run only inside 20-sim"
        diagnostics.error("model-dll", span, message, hint="avoid dll() in the model")
