# SPDX-License-Identifier: Apache-2.0
"""Loads the ideal control loop that a scenario names.  It is a Python file with one function, independent of the model.

``reference(axis: str, time: Sequence[float], setpoint: Sequence[float]) -> list[float]`` gets the setpoint over time,
in seconds, and returns the position of an ideal control loop.  This loop starts at rest at the first setpoint.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import NoReturn

from epg.generator.diagnostics import Diagnostics, UserError
from epg.generator.source import Span

Reference = Callable[[str, Sequence[float], Sequence[float]], list[float]]


def load_reference(path: Path) -> Reference:
    """The function ``reference`` of a Python file.

    Raises UserError if the file cannot be loaded or does not define it.  The function that is returned raises UserError
    if ``reference`` fails, or if it does not return one finite value for each time.
    """
    # The file is executed instead of imported, because an import would write a __pycache__ beside the user's file.
    # The module must be in sys.modules nevertheless, because dataclasses look up their annotations there.
    module = ModuleType(f"epg_reference_{path.stem}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module
    try:
        exec(compile(path.read_bytes(), str(path), "exec"), module.__dict__)
        function: Reference = module.reference
    except Exception as error:  # any exception is a mistake in the user's file
        _fail(path, f"cannot load the reference: {type(error).__name__}: {error}")

    def checked(axis: str, time: Sequence[float], setpoint: Sequence[float]) -> list[float]:
        try:
            values = [float(value) for value in function(axis, time, setpoint)]
        except Exception as error:
            _fail(path, f"reference() failed for axis '{axis}': {type(error).__name__}: {error}")
        if len(values) != len(time) or not all(map(math.isfinite, values)):
            _fail(path, f"reference() must return {len(time)} finite values for axis '{axis}'")
        return values

    return checked


def _fail(path: Path, message: str) -> NoReturn:
    diagnostics = Diagnostics()
    hint = "the file must define reference(axis, time, setpoint), which returns a list as long as time"
    diagnostics.error("wrong-reference", Span(str(path)), message, hint=hint)
    raise UserError(diagnostics)
