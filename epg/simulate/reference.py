# SPDX-License-Identifier: Apache-2.0
"""The ideal loop that a scenario names: a Python file with one function, written independently of the model.

``reference(axis: str, time: Sequence[float], setpoint: Sequence[float]) -> list[float]`` gets the profile over time
(s) and returns the position an ideal loop would have; it starts at rest at the first setpoint.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import ModuleType
from typing import NoReturn

from epg.diagnostics import Diagnostics, UserError
from epg.source import Span

Reference = Callable[[str, Sequence[float], Sequence[float]], list[float]]


def load_reference(path: Path) -> Reference:
    """The function ``reference`` of a Python file.  Raises UserError when there is none."""
    # Executed rather than imported: an import would leave a __pycache__ beside the user's file.  The module is
    # registered all the same, because dataclasses look their annotations up there.
    module = ModuleType(f"epg_reference_{path.stem}")
    module.__file__ = str(path)
    sys.modules[module.__name__] = module
    try:
        exec(compile(path.read_bytes(), str(path), "exec"), module.__dict__)
        function: Reference = module.reference
    except Exception as error:  # the file is the user's: whatever it raises is about the file
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
    hint = "it needs: def reference(axis, time, setpoint), which returns a list as long as time"
    diagnostics.error("wrong-reference", Span(str(path)), message, hint=hint)
    raise UserError(diagnostics)
