# SPDX-License-Identifier: Apache-2.0
"""The terminal's questions about ports: with which component each is connected."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from epg.connect.terminal.talk import Talk
from epg.connect.terminal.text import (
    UNCONNECTED,
    ModelPort,
    candidate_rows,
    is_open,
    ports_of,
    wire_rows,
    wire_text,
)

HELP = """\
  Enter  use the answer in [ ]; without one, leave the port open
  2      connect the component with this number. You can also type its name, or
         the start of its name. An output can have several: 2, pwm_tilt
  -      leave an output unconnected on purpose
  ?      explain the candidates         c  connect with a conversion
  s      show all wires                 u  undo the last change
  b      go back to the previous port   d  remove the wire
  e      end the questions about ports  q  quit"""
NONE_FITS = "no component fits: h lists the possible answers"


class Ports:
    """Asks about one port after the other."""

    def __init__(self, talk: Talk) -> None:
        self._talk, self._console = talk, talk.console
        self._commands: dict[str, Callable[[ModelPort], bool]] = {
            "?": self._explain,
            "s": self.show,
            "u": self.undo,
            "d": self._disconnect,
            "c": self._convert,
            "h": self._help,
        }

    def ask(self, wanted: Sequence[ModelPort], ports: Sequence[ModelPort]) -> None:
        """Asks about each port of ``wanted``.  The answer ``b`` goes back to the previous one of all ``ports``."""
        queue = list(wanted)
        while queue:
            port = queue[0]
            answer = self._answer(port)
            if answer == "b":
                before = ports[: ports.index(port)]
                if before:
                    queue.insert(0, before[-1])
                else:
                    self._console.say("this is the first port")
            elif answer == "q":
                self._talk.leave()
            elif answer == "e":
                return
            elif self._answered(port, answer):
                queue.pop(0)

    def _answer(self, port: ModelPort) -> str:
        """Asks about one port, and returns the answer.

        Enter returns the proposal of an open port.  It returns "" if there is none, or if the port is connected.
        """
        ports = ports_of(self._talk.state)
        self._console.say()
        number = [other.name for other in ports].index(port.name) + 1
        self._console.fill(
            f"{number}/{len(ports)} {port.title}" + (f": {port.description}" if port.description else "")
        )
        names = self._talk.state["candidates"].get(port.name, ())
        self._console.items([f"{number} {name}" for number, name in enumerate(names, 1)] or [NONE_FITS], "    ")
        default = self._talk.state["proposals"].get(port.name, "")
        if not is_open(self._talk.state, port):
            default = wire_text(self._talk.state, port)
        answer = self._console.ask(f"{port.name} {port.arrow}", default)
        return "" if answer == default and not is_open(self._talk.state, port) else answer

    def _answered(self, port: ModelPort, answer: str) -> bool:
        """Does what the answer says.  Returns True if the next port follows."""
        if not answer:
            return True  # the port stays as it is
        if answer in self._commands:
            return self._commands[answer](port)
        if answer in ("-", UNCONNECTED):
            if port.direction == "input":
                self._console.say("an input needs a value: connect it, or press Enter to leave it open for now")
                return False
            return self._connect(port, [])
        names = self._references(port, answer)
        return names is not None and self._connect(port, [{"reference": name} for name in names])

    def _references(self, port: ModelPort, answer: str) -> list[str] | None:
        """The component ports that a list of numbers and names means; None after a message about a wrong one."""
        candidates = list(self._talk.state["candidates"].get(port.name, ()))
        every = [offered["reference"] for component in self._talk.state["components"] for offered in component["ports"]]
        names = []
        for word in (word.strip() for word in answer.split(",")):
            if word.isdecimal() and 0 < int(word) <= len(candidates):
                name: str | None = candidates[int(word) - 1]
            elif word in every:  # if it does not fit, the session refuses it with the command line's message
                name = word
            else:
                name = self._talk.named(word, candidates, "candidate")
            if name is None:
                return None
            names.append(name)
        return names

    def _connect(self, port: ModelPort, ends: list[dict[str, Any]]) -> bool:
        return self._talk.act("connect", {"port": port.name, "ends": ends}, port)

    def _help(self, port: ModelPort) -> bool:
        self._console.say(HELP)
        return False

    def _explain(self, port: ModelPort) -> bool:
        self._console.table(("", "component", "what it is"), candidate_rows(self._talk.state, port))
        return False

    def show(self, port: ModelPort | None) -> bool:
        self._console.table(("port", "", "component", "where"), wire_rows(self._talk.state))
        return False

    def undo(self, port: ModelPort | None) -> bool:
        before = self._talk.state["wires"]
        if self._talk.act("undo", {}):
            after = self._talk.state["wires"]
            changed = [other for other in ports_of(self._talk.state) if before.get(other.name) != after.get(other.name)]
            for other in changed:
                self._console.say(f"undone: {other.name} {other.arrow} {wire_text(self._talk.state, other)}")
        return False

    def _disconnect(self, port: ModelPort) -> bool:
        if is_open(self._talk.state, port):
            self._console.say(f"{port.name} is already open")
        else:
            self._talk.act("disconnect", {"port": port.name}, port)
        return False

    def _convert(self, port: ModelPort) -> bool:
        """Asks for a component and the conversion of its values."""
        ends = self._talk.state["wires"].get(port.name) or []
        now = ends[0] if len(ends) == 1 else {}
        answer = self._console.ask(
            "component", now.get("reference") or self._talk.state["proposals"].get(port.name, "")
        )
        names = self._references(port, answer) if answer else None
        if names is None or len(names) != 1:
            return False
        self._console.say("A value is multiplied by scale, then offset is added, then limits apply.")
        end: dict[str, Any] = {"reference": names[0]}
        for key, example in (("scale", "0.5 or 1/4"), ("offset", "-1.5"), ("unit", "deg")):
            end[key] = _cleared(self._console.ask(f"{key}, such as {example}", now.get(key, "")))
        limits = " ".join(now.get("limits") or ())
        words = _cleared(self._console.ask("limits, such as -1 1", limits)).replace(",", " ").split()
        if words:
            end["limits"] = words
        return self._connect(port, [end])


def _cleared(answer: str) -> str:
    """The answer; "" for ``-``, which removes the present value."""
    return "" if answer == "-" else answer
