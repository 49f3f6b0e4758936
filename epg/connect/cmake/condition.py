# SPDX-License-Identifier: Apache-2.0
"""CMake's if(): true, false, or None where that cannot be known.

Source: cmake-commands(7), if(), sections "Basic Expressions", "Logic Operators" and "Condition Syntax".
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from epg.connect.cmake.syntax import Argument
from epg.connect.cmake.values import Variables, expression
from epg.documents.text_file import is_file, is_folder

_TRUE = re.compile(r"(ON|YES|TRUE|Y|-?[0-9]*[1-9][0-9]*)$", re.IGNORECASE)
_FALSE = re.compile(r"(0|OFF|NO|FALSE|N|IGNORE|NOTFOUND|.*-NOTFOUND|)$", re.IGNORECASE)
_UNARY = ("EXISTS", "IS_DIRECTORY", "DEFINED", "COMMAND", "TARGET", "TEST", "POLICY", "IS_ABSOLUTE", "IS_SYMLINK")
_BINARY = re.compile(
    r"(MATCHES|IN_LIST|EQUAL|STREQUAL|PATH_EQUAL|IS_NEWER_THAN|(STR|VERSION_)?(LESS|GREATER|EQUAL)(_EQUAL)?)$"
)


def condition(arguments: Sequence[Argument], variables: Variables) -> bool | None:
    """What if(<arguments>) decides."""
    return _Condition(arguments, variables).value()


class _Condition:
    def __init__(self, arguments: Sequence[Argument], variables: Variables) -> None:
        self.left = list(arguments)
        self.variables = variables

    def value(self) -> bool | None:
        found = self._or()
        return found if not self.left else None

    def _is(self, *words: str) -> bool:
        return bool(self.left) and self.left[0].form == "plain" and self.left[0].text in words

    def _or(self) -> bool | None:
        found = self._and()
        while self._is("OR"):
            self.left.pop(0)
            other = self._and()
            found = True if found or other else None if found is None or other is None else False
        return found

    def _and(self) -> bool | None:
        found = self._not()
        while self._is("AND"):
            self.left.pop(0)
            other = self._not()
            found = False if found is False or other is False else None if found is None or other is None else True
        return found

    def _not(self) -> bool | None:
        if self._is("NOT"):
            self.left.pop(0)
            found = self._not()
            return None if found is None else not found
        return self._test()

    def _test(self) -> bool | None:
        if not self.left:
            return None
        if self._is("("):
            self.left.pop(0)
            found = self._or()
            if self._is(")"):
                self.left.pop(0)
                return found
            return None
        first = self.left.pop(0)
        if first.form == "plain" and first.text in _UNARY and self.left:
            return self._unary(first.text, self.left.pop(0))
        if len(self.left) > 1 and self.left[0].form == "plain" and _BINARY.match(self.left[0].text):
            return self._binary(first, self.left.pop(0).text, self.left.pop(0))
        return self._truth(first)

    def _unary(self, test: str, argument: Argument) -> bool | None:
        text = self.variables.expand(argument.text)
        if text is None:
            return None
        if test == "DEFINED":
            return True if self.variables.get(text) is not None else None
        if test in ("EXISTS", "IS_DIRECTORY") and Path(text).is_absolute():
            return is_folder(Path(text)) or (test == "EXISTS" and is_file(Path(text)))
        return None

    def _binary(self, first: Argument, test: str, second: Argument) -> bool | None:
        left = self._operand(first)
        if test == "IN_LIST":
            name = self.variables.expand(second.text)
            values = None if name is None else self.variables.get(name)
            return None if left is None or values is None else left in values.split(";")
        right = self.variables.expand(second.text) if test == "MATCHES" else self._operand(second)
        if left is None or right is None:
            return None
        if test == "STREQUAL" or (test == "EQUAL" and left.isdigit() and right.isdigit()):
            return left == right if test == "STREQUAL" else int(left) == int(right)
        pattern = expression(right) if test == "MATCHES" else None
        return pattern.search(left) is not None if pattern is not None and len(left) < 300 else None

    def _operand(self, argument: Argument) -> str | None:
        """A value, or the variable of that name: one in capitals may be set where nobody looks."""
        text = self.variables.expand(argument.text)
        if text is None or argument.form != "plain":
            return text
        value = self.variables.get(text)
        return value if value is not None or self.variables.has(text) or re.fullmatch("[A-Z][A-Z0-9_]+", text) else text

    def _truth(self, argument: Argument) -> bool | None:
        text = self.variables.expand(argument.text)
        if text is None:
            return None
        if _TRUE.match(text) or _FALSE.match(text):
            return _TRUE.match(text) is not None
        if argument.form != "plain":
            return False
        value = self.variables.get(text)
        return None if value is None else _FALSE.match(value) is None
