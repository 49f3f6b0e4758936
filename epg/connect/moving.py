# SPDX-License-Identifier: Apache-2.0
"""Moves a target to another board, platform or robot configuration: plans the changes of its ``.tcf``.

The plan follows from the messages of the ordinary check.  After the change, each error in the user's ``.tcf`` that was
not there before leads to one more change: pins are proposed, a middleware or a transport is replaced, and a setting
that the new target does not have is dropped.  The user must correct the errors that are left.

>>> # move = plan_move(loaded, request, path, SetValue(("target",), "nucleo_h743zi_freertos"), models)
>>> # move.items, move.operation
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import asdict, field, replace
from pathlib import Path
from typing import Any

from epg.connect.draft import RemoveValue, SetValue
from epg.connect.loaded import Loaded, Models, load, value_at
from epg.connect.pinout import lacking_pins
from epg.edit.tcf import COMPONENTS, remove_value, set_value
from epg.generator.check.configuration import Configuration
from epg.generator.check.middleware import first_middleware, offered
from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostic, Diagnostics
from epg.generator.project import Request, load_configuration
from epg.generator.resolve.first_fit import ClaimSignal, first_fit, signals_of
from epg.generator.source import YamlNode

_SETTINGS = ("clocks", "control", "communication")
"""The sections whose settings are dropped if the new target does not have them."""
_ROUNDS = 50
"""The largest number of changes, which is more than the settings of any ``.tcf``."""


@dataclass(frozen=True)
class MovedValue:
    """What happens to one value: ``what`` is "changed", "dropped", "asked" or "kept".

    ``before`` and ``after`` are its texts; ``reason`` is the message about the old value.
    """

    what: str
    key: str
    before: str = ""
    after: str = ""
    reason: str = ""

    def data(self) -> dict[str, Any]:
        return asdict(self)


@dataclass
class TcfMove:
    """The changes of the ``.tcf`` so far: its new ``text``, and the operations that make it."""

    text: str
    items: list[MovedValue] = field(default_factory=list)
    operation: list[SetValue | RemoveValue] = field(default_factory=list)


def plan_move(loaded: Loaded, request: Request, path: Path, change: SetValue, models: Models) -> TcfMove:
    """The changes after ``change`` of the ``.tcf`` in ``path``, which gave ``loaded``.

    ``request`` is that of the moved target, with the present text of the ``.tcf`` as a draft.  The text must be correct
    YAML.  Raises CannotEdit if EPG cannot edit its form.
    """
    return _Plan(loaded, request, path, models).made(change)


class _Plan:
    def __init__(self, loaded: Loaded, request: Request, path: Path, models: Models) -> None:
        self.loaded, self.request, self.path, self.models = loaded, request, path, models
        self.move = TcfMove(request.drafts[path])
        self.own = loaded.chain[0].node
        self.before = {(each.id, each.message) for each in _errors(loaded)}
        self.tried: set[tuple[str, ...]] = set()

    def made(self, first: SetValue) -> TcfMove:
        self.change(first.path, first.value)
        for _ in range(_ROUNDS):
            now = self.now()
            if not any(self.correct(problem, now) for problem in self.new_errors(now)):
                break
        self.propose_pins()
        last = self.now()
        for problem in self.new_errors(last):
            path = last.places.path(problem)
            hint = f": {problem.hint}" if problem.hint else ""
            self.move.items.append(
                MovedValue("asked", ".".join(path) or problem.span.file, reason=f"{problem.message}{hint}")
            )
        self.keep()
        return self.move

    def change(self, path: Sequence[str], value: object, reason: str = "") -> None:
        before = self.stated(path)
        self.move.text = set_value(self.move.text, self.path.name, path, value)
        self.move.operation.append(SetValue(tuple(path), value))
        self.move.items.append(MovedValue("changed", ".".join(path), before, str(value), reason))

    def drop(self, path: Sequence[str], reason: str) -> bool:
        """Removes a value of the user's file.  Returns False if it is that of an extended file."""
        if self.own.get(*path) is None:
            return False
        before = self.stated(path)
        self.move.text = remove_value(self.move.text, self.path.name, path)
        self.move.operation.append(RemoveValue(tuple(path)))
        self.move.items.append(MovedValue("dropped", ".".join(path), before, "", reason))
        return True

    def stated(self, path: Sequence[str]) -> str:
        node = self.own.get(*path) or value_at(self.loaded.tree, *path)
        return "" if node is None else _text(node)

    def now(self) -> Loaded:
        """The target with the changes so far."""
        request = replace(self.request, drafts={**self.request.drafts, self.path: self.move.text})
        return load(request, self.models, self.loaded.catalog)

    def new_errors(self, now: Loaded) -> list[Diagnostic]:
        return [each for each in _errors(now) if (each.id, each.message) not in self.before]

    def correct(self, problem: Diagnostic, now: Loaded) -> bool:
        """Corrects a mistake by a change of settings.  Returns False if EPG cannot, or has tried already."""
        path = tuple(now.places.path(problem))
        target = now.target
        if len(path) < 2 or path in self.tried or target is None:
            return False
        self.tried.add(path)
        if path == ("communication", "middleware"):
            self.change(path, first_middleware(target, now.catalog), problem.message)
        elif path == ("communication", "transport"):
            middleware = value_at(now.tree, "communication", "middleware")
            name = str(middleware.value) if middleware is not None else first_middleware(target, now.catalog)
            transports = offered(target, now.catalog).get(name, ())
            if not transports:
                return self.drop(path, problem.message)
            self.change(path, transports[0], problem.message)
        elif path[0] in _SETTINGS or path[2:3] == ("node",):  # a node of a devicetree
            return self.drop(path, problem.message)
        else:
            return False
        return True

    def propose_pins(self) -> None:
        """Gives new pins to the signals whose pins do not fit: as few as possible, or to all.

        If there are no pins for all of them, each component gets some for which there are.
        """
        unwired = self.without_pins()
        if unwired is None or not unwired.target.has_pins:
            return
        written = signals_of(unwired)
        unusable = set(lacking_pins(unwired))
        wrong = unusable | self.wrong_signals(unwired)
        tries = dict.fromkeys(map(frozenset, (unusable, wrong, written)))  # a search can take seconds
        if not wrong:
            return
        for wanted in tries:
            pins = self.fitting(unwired, wanted)
            if pins and self.are_right(pins):
                self.write_pins(pins, written)
                return
        for name in dict.fromkeys(component for component, _ in sorted(wrong)):
            configuration = self.without_pins() or unwired
            pins = self.fitting(configuration, {signal for signal in wrong if signal[0] == name})
            self.write_pins(pins, written)

    def without_pins(self) -> Configuration | None:
        """The configuration with the changes so far, in which components may have no pins."""
        return load_configuration(self.now().request, self.loaded.catalog, Diagnostics(), pins_required=False)

    def fitting(self, configuration: Configuration, wanted: Collection[ClaimSignal]) -> dict[ClaimSignal, str]:
        model = self.loaded.parts.model
        period = configuration.control.period or (model.step if model is not None else None)
        return (first_fit(configuration, period, wanted) if wanted else None) or {}

    def write_pins(self, pins: Mapping[ClaimSignal, str], written: Mapping[ClaimSignal, str]) -> None:
        for (component, pin), name in pins.items():
            if written[component, pin] != name:
                self.change((COMPONENTS, component, "pins", pin), name, "a free pin that fits")

    def wrong_signals(self, configuration: Configuration) -> set[ClaimSignal]:
        """The signals of the components with errors about their pins."""
        now = self.now()
        about = [now.places.path(problem) for problem in self.new_errors(now)]
        names = {path[1] for path in about if path[:1] == [COMPONENTS] and len(path) > 1}
        return {signal for signal in signals_of(configuration) if signal[0] in names}

    def are_right(self, pins: Mapping[ClaimSignal, str]) -> bool:
        """True if fewer errors about components are left with ``pins``."""
        text = self.move.text
        before = len(self.new_errors(self.now()))
        for (component, pin), name in pins.items():
            self.move.text = set_value(self.move.text, self.path.name, (COMPONENTS, component, "pins", pin), name)
        now = self.now()
        left = [now.places.path(problem) for problem in self.new_errors(now)]
        self.move.text = text
        return not any("pins" in path for path in left) and len(left) <= before

    def keep(self) -> None:
        """Lists the values of the user's file that stay: each component, and each other setting."""
        touched = [item.key for item in self.move.items]
        for key, node in self.own.items():
            if key in ("version", "target", "extends"):
                continue
            for name, child in node.items() if node.is_mapping else [("", node)]:
                path = f"{key}.{name}".rstrip(".")
                if path not in touched:
                    kind = child.get("kind") if key == COMPONENTS else None
                    self.move.items.append(MovedValue("kept", path, _text(child if kind is None else kind)))


def _errors(loaded: Loaded) -> list[Diagnostic]:
    return [problem for problem in loaded.diagnostics if problem.severity == "error"]


def _text(node: YamlNode) -> str:
    value = node.plain()
    if isinstance(value, dict):
        return ", ".join(f"{key}: {each}" for key, each in value.items())
    return str(value).lower() if isinstance(value, bool) else str(value)
