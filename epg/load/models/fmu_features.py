"""What an FMU does that a target cannot: found in the code behind the functions EPG calls.

An FMU may allocate memory while it starts: it gets that from an array of fixed size.  In a step it may not.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

from epg.diagnostics import Diagnostics
from epg.load.models.c_code import Code, Function
from epg.load.models.features import HEAP, check_features
from epg.load.models.link import Linked

#: the heap that EPG gives to FMUs; their callbacks (FMI 2.0.4, 2.1.5) lead to the same
PROVIDED = frozenset(("malloc", "calloc", "realloc", "free", "strdup"))
_CALLBACK = re.compile(r"\ballocateMemory\s*\)?\s*\(")
_START = """Instantiate InstantiateCoSimulation SetupExperiment EnterInitializationMode ExitInitializationMode
Terminate FreeInstance""".split()
_RUN = (
    """DoStep GetReal GetInteger GetBoolean SetReal SetInteger SetBoolean GetBooleanStatus GetFloat64 GetFloat32
SetFloat64 SetFloat32""".split()
    + [f"{verb}{sign}Int{bits}" for verb in ("Get", "Set") for sign in ("", "U") for bits in (8, 16, 32, 64)]
)


def check_fmu(linked: Linked, standard: int, diagnostics: Diagnostics) -> None:
    """Reports what cannot run, and what a user should know of."""
    before = diagnostics.error_count
    running = _named(linked, standard, _RUN)
    check_features(linked, running, "", diagnostics, foreign=True)
    for code, function in linked.reachable(running):
        for match in _CALLBACK.finditer(code.body(function)):
            start = function.body_start + match.start()
            span = code.file.span(start, start + len("allocateMemory"))
            message = "memory is allocated while the model runs"
            diagnostics.error("model-heap", span, message, hint="allocate it in fmi2Instantiate, or use arrays")
    if diagnostics.error_count == before:
        check_features(linked, _named(linked, standard, _START), "", diagnostics, foreign=True, allowed=PROVIDED)


def uses_heap(codes: Iterable[Code]) -> bool:
    """Whether there is anything in the sources that may want memory."""
    wanted = HEAP | {"allocateMemory"}
    for code in codes:
        in_macros = (word for macro in code.macros for word in re.findall(r"\w+", macro.value))
        if wanted & code.used or not wanted.isdisjoint(in_macros):
            return True
    return False


def _named(linked: Linked, standard: int, names: Iterable[str]) -> list[Function]:
    wanted = {f"fmi{standard}{name}" for name in names}
    return [function for _, function in linked.functions() if function.name in wanted]
