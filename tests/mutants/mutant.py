# SPDX-License-Identifier: Apache-2.0
"""A mutant: one small change of one statement, and the identity by which a later run finds it again.

The identity does not contain files, lines or comments: it stays valid when code moves.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Identity:
    """The function (``Class.method``) and its statement before and after the change, each on one line."""

    function: str
    before: str
    after: str


@dataclass(frozen=True)
class Mutant:
    identity: Identity
    file: str
    """Path from the root of the project, with slashes."""
    lines: range
    """The lines of the statement, or of its head if it has a body."""
    at_import: bool
    """True if Python runs the statement while it imports the module."""
    changed: Callable[[], ast.Module | str]
    """The whole file with the change: a module of Python with the lines of the original, or the text of C."""

    def text(self) -> str:
        changed = self.changed()
        return changed if isinstance(changed, str) else ast.unparse(changed) + "\n"
