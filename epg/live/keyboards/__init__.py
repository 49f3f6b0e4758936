# SPDX-License-Identifier: Apache-2.0
"""The keyboard of a terminal, which gives each key at once and shows none: a module for each ``os.name``."""

from __future__ import annotations

import importlib
import os
from typing import Protocol, cast


class Keyboard(Protocol):
    """Used by ``with``.  An :class:`OSError` with ``EIO`` says that the terminal has closed."""

    def is_here(self) -> bool:
        """True if a person sees the output and can press keys."""
        ...

    def __enter__(self) -> Keyboard: ...
    def __exit__(self, *_: object) -> None: ...

    def pressed(self, seconds: float) -> str:
        """The characters of the keys that were pressed, after at most ``seconds``.  An arrow key has none."""
        ...


def keyboard() -> Keyboard:
    return cast(Keyboard, importlib.import_module(f"epg.live.keyboards.keys_{os.name}").keyboard())
