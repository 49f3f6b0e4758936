# SPDX-License-Identifier: Apache-2.0
"""Data classes of which the import is fast.

>>> # @dataclass(frozen=True)
>>> # class Span:
>>> #     file: str
>>> #     line: int = 0

``dataclasses.dataclass`` compiles up to six methods for each class.  In a run of the generator that took eight times as
long as ``python -c pass``.  :func:`dataclass` lets the standard library collect the fields only.  It compiles
``__init__`` for a class with many objects, and no other method.  The functions of ``dataclasses``, such as ``field()``,
``replace()`` and ``asdict()``, work with these classes, too.
"""

from __future__ import annotations

import dataclasses
from operator import attrgetter
from typing import TYPE_CHECKING, Any

MANY = 32
"""The number of objects of a class that take about as long as the compilation of its ``__init__``."""

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:

    def dataclass(cls=None, /, *, frozen=False):
        """Does the same as ``dataclasses.dataclass`` with these arguments."""
        return _finish(cls, frozen) if cls is not None else lambda cls: _finish(cls, frozen)


def _finish(cls: type[Any], frozen: bool) -> type[Any]:
    """Makes ``cls`` a data class.  Methods that its body defines stay as they are."""
    own = set(vars(cls))
    types = vars(cls).get("__annotations__", {})
    # The standard library parses each annotation three times to find the few that are no fields.
    cls.__annotations__ = {name: type if "ClassVar" in str(type) else object for name, type in types.items()}
    dataclasses.dataclass(init=False, repr=False, eq=False)(cls)
    cls.__annotations__ = types
    for field in dataclasses.fields(cls):
        field.type = types.get(field.name, field.type)
    compared = [field.name for field in dataclasses.fields(cls) if field.compare]
    values = attrgetter(*compared) if compared else lambda self: ()

    def __eq__(self: Any, other: object) -> Any:
        return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

    def __hash__(self: Any) -> int:
        return hash(values(self))

    methods: dict[str, Any] = {"__init__": _first_init(cls), "__repr__": _repr, "__eq__": __eq__}
    if frozen:
        methods |= {"__hash__": __hash__, "__setattr__": _refuse, "__delattr__": _refuse}
    elif "__eq__" not in own:
        methods["__hash__"] = None
    for name, method in methods.items():
        # Python adds "__hash__ = None" to a class whose body defines "__eq__".
        if name not in own or (name == "__hash__" and vars(cls)[name] is None):
            setattr(cls, name, method)
    return cls


def _first_init(cls: type[Any]) -> Any:
    """The function ``__init__`` for the first objects of a data class.  It is not compiled, so it is made fast.

    The compiled one replaces it after :data:`MANY` objects, or earlier to raise the TypeError for wrong arguments.
    """
    fields = dataclasses.fields(cls)
    names = [field.name for field in fields]
    defaults = {field.name: field.default for field in fields if field.default is not dataclasses.MISSING}
    makers = [(f.name, f.default_factory) for f in fields if f.default_factory is not dataclasses.MISSING]
    left = MANY

    def __init__(self: Any, /, *arguments: Any, **named: Any) -> None:
        nonlocal left
        left -= 1
        values = {**defaults, **dict(zip(names, arguments)), **named}
        for name, make in makers:
            if name not in values:
                values[name] = make()
        right = len(arguments) <= len(names) and named.keys().isdisjoint(names[: len(arguments)])
        if left == 0 or not right or values.keys() != set(names):
            cls.__init__ = made = _init(cls)
            made(self, *arguments, **named)
            return
        self.__dict__.update(values)
        if hasattr(cls, "__post_init__"):
            self.__post_init__()

    return __init__


def _init(cls: type[Any]) -> Any:
    """The compiled ``__init__`` of a data class.  It changes ``__dict__``: a frozen class refuses assignments."""
    known: dict[str, Any] = {"MISSING": dataclasses.MISSING}
    parameters, values = [], []
    for field in dataclasses.fields(cls):
        name = field.name
        if field.default_factory is not dataclasses.MISSING:
            known[f"make_{name}"] = field.default_factory
            parameters.append(f"{name}=MISSING")
            values.append(f"{name}=make_{name}() if {name} is MISSING else {name}")
        else:
            known[f"default_{name}"] = field.default
            parameters.append(name if field.default is dataclasses.MISSING else f"{name}=default_{name}")
            values.append(f"{name}={name}")
    lines = [f"def __init__(self, {', '.join(parameters)}):", f"    self.__dict__.update({', '.join(values)})"]
    if hasattr(cls, "__post_init__"):
        lines.append("    self.__post_init__()")
    exec("\n".join(lines), known)
    known["__init__"].__qualname__ = f"{cls.__qualname__}.__init__"
    return known["__init__"]


def _repr(self: Any) -> str:
    shown = (f"{field.name}={getattr(self, field.name)!r}" for field in dataclasses.fields(self) if field.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _refuse(self: Any, name: str, value: object = None) -> None:
    raise dataclasses.FrozenInstanceError(f"cannot change field {name!r}")
