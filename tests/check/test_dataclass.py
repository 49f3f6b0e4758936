# SPDX-License-Identifier: Apache-2.0
"""EPG's data classes behave as those of the standard library."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import pytest

from epg.generator import dataclass as quick


def made(dataclass: Callable[..., Any]) -> tuple[Any, Any, Any]:
    """A frozen class, a frozen class with a base, and a class of which objects can change."""

    @dataclass(frozen=True)
    class Pin:
        """The names of the fields are also names that a careless ``__init__`` would use."""

        values: int
        name: str = "pin"
        items: list[int] = dataclasses.field(default_factory=list)
        hidden: object = dataclasses.field(default=None, repr=False, compare=False)
        kind = "no field"

        @property
        def double(self) -> int:
            return 2 * self.values

    @dataclass(frozen=True)
    class Button(Pin):
        """Has a field more, and other values by default."""

        name: str = "button"
        pressed: bool = False

    @dataclass
    class Count:
        """Counts."""

        number: int = 0
        doubled: int = 0

        def __post_init__(self) -> None:
            self.doubled = 2 * self.number

    return Pin, Button, Count


def observed(action: Callable[[], object]) -> object:
    """The result of an action, or the type of its exception."""
    try:
        return action()
    except Exception as error:
        return type(error)


ACTIONS: dict[str, Callable[[Any, Any, Any], object]] = {
    "positions and names": lambda p, b, c: [
        repr(p(1)),
        repr(p(1, "a", hidden=3)),
        repr(b(1, pressed=True)),
        repr(c(4)),
    ],
    "values": lambda p, b, c: [vars(p(1, "a", [2], 3)), vars(b(1)), vars(c(4)), p(3).double, p(3).kind],
    "too few": lambda p, b, c: p(),
    "too many": lambda p, b, c: c(1, 2, 3),
    "twice": lambda p, b, c: p(1, values=2),
    "right after a mistake": lambda p, b, c: [observed(p), repr(p(1)), repr(p(2, items=[3]))],
    "unknown name": lambda p, b, c: p(1, other=2),
    "equal": lambda p, b, c: [p(1) == p(1), p(1) == p(2), p(1) == p(1, hidden=5), p(1) == b(1, "pin"), p(1) == 1],
    "own lists": lambda p, b, c: p(1).items is p(1).items,
    "hash": lambda p, b, c: hash(p(1, items=())) == hash(p(1, items=(), hidden=5)),
    "hash of a list": lambda p, b, c: hash(p(1)),
    "hash of what can change": lambda p, b, c: hash(c()),
    "assignment": lambda p, b, c: setattr(p(1), "name", "other"),
    "deletion": lambda p, b, c: delattr(b(1), "name"),
    "allowed assignment": lambda p, b, c: setattr(c(1), "number", 2),
    "replace": lambda p, b, c: [
        repr(dataclasses.replace(p(1), name="other")),
        repr(dataclasses.replace(b(1), values=3)),
    ],
    "fields": lambda p, b, c: [[f.name for f in dataclasses.fields(each)] for each in (p, b, c)],
    "asdict": lambda p, b, c: dataclasses.asdict(b(1, items=[2])),
    "pattern": lambda p, b, c: b.__match_args__,
    "initialised again": lambda p, b, c: repr(c(3).__init__(5)),
}


@pytest.mark.parametrize("action", ACTIONS)
def test_a_class_behaves_as_one_of_the_standard_library(action: str) -> None:
    expected = observed(lambda: ACTIONS[action](*made(dataclasses.dataclass)))
    assert observed(lambda: ACTIONS[action](*made(quick.dataclass))) == expected


def test_methods_of_the_class_are_kept() -> None:
    @quick.dataclass(frozen=True)
    class Name:
        """Compares without case."""

        text: str

        def __eq__(self, other: object) -> bool:
            return isinstance(other, Name) and self.text.lower() == other.text.lower()

        def __repr__(self) -> str:
            return self.text

    assert Name("a") == Name("A")
    assert repr(Name("a")) == "a"
    assert hash(Name("a")) == hash(Name("a"))


def test_a_method_is_compiled_for_a_class_with_many_objects(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = []
    monkeypatch.setattr(quick, "_init", lambda cls, make=quick._init: compiled.append(cls) or make(cls))
    pin, button, _ = made(quick.dataclass)
    for number in range(2 * quick.MANY):
        assert button(number, items=[number]) == button(number, "button", [number], pressed=False)
        assert button(number).items == []
    assert compiled == [button]
    assert pin(1).values == 1
    assert compiled == [button]
