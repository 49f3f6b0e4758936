"""``epg connect --terminal``: the page's questions, one after the other, for who has no browser, and for scripts.

>>> # status = run(session, sys.stdin, sys.stdout)

Answers may come from a file: each question takes one line.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, TextIO

from epg.connect.console import Console, Ended
from epg.connect.session import Refused, Session, State
from epg.connect.terminal_build import build
from epg.connect.terminal_create import Left, create_project
from epg.connect.terminal_message import say_message
from epg.connect.terminal_text import (
    UNCONNECTED,
    Port,
    candidate_rows,
    is_open,
    ports_of,
    wire_rows,
    wire_text,
)

HELP = """\
  Enter  take what stands in [ ]; where nothing does, leave the port open
  2      the component of that number; or its name; or the beginning of it, if
         no other begins so. An output takes several: 2, pwm_tilt
  -      leave an output unconnected on purpose
  ?      explain the candidates         c  connect with a conversion
  s      all wires so far               u  undo the last change
  b      back to the port before        d  take the wire away
  e      enough: to the end             q  leave"""
NONE_FITS = "no component fits: h lists what can be answered"
OF_OPEN_PORTS = frozenset(("unbound-input", "unbound-output", "needs-bound", "unused-component"))
"""Messages that are there while ports are still to be asked for."""
LEFT_UNSAVED, INTERRUPTED = 1, 130


def run(session: Session, input: TextIO, output: TextIO) -> int:
    """Asks until all is done; the exit status: 0, or 1 where something is wrong, not saved or not built."""
    console = Console(input, output)
    try:
        if session.state()["phase"] == "choose":
            create_project(session, console)
            project = session.state()["project"]
            console.say(f"wrote the project {project['folder']}")
        return _Dialog(session, console).run()
    except Left:
        return 0
    except Ended:
        lost = session.state()["phase"] == "choose" or session.state()["draft"]["changed"]
        console.say("the answers have ended" + (": nothing was saved" if lost else ""))
        return LEFT_UNSAVED if lost else 0
    except KeyboardInterrupt:
        console.say()
        return INTERRUPTED
    finally:
        session.close()


class _Dialog:
    """The questions about one target."""

    def __init__(self, session: Session, console: Console) -> None:
        self._session, self._console = session, console
        self._state: State = session.state()
        self._told = ""  # what was edited outside, as it was said last
        self._commands: dict[str, Callable[[Port], bool]] = {
            "?": self._explain,
            "s": self._show,
            "u": self._undo,
            "d": self._disconnect,
            "c": self._convert,
            "h": self._help,
        }

    def run(self) -> int:
        self._choose_target()
        self._introduce()
        if not self._state["editable"]:
            self._say_messages(self._state["diagnostics"])
            self._console.say(self._state["why_not"])
            return 1
        ports = ports_of(self._state)
        self._ask_ports([port for port in ports if is_open(self._state, port)], ports)
        shown = None
        while True:
            if shown != self._state["wires"]:
                shown = self._state["wires"]
                self._console.say()
                self._show(None)
                self._say_messages(self._state["diagnostics"])
            answer = self._console.ask("a port to change, u to undo, q to leave, Enter to go on", "")
            if not answer:
                return self._finish()
            if answer == "q":
                self._leave()
            elif answer == "u":
                self._undo(None)
            elif answer == "s":
                shown = None
            else:
                named = self._named(answer, [port.name for port in ports], "port")
                if named is not None:
                    self._ask_ports([port for port in ports if port.name == named], ports)

    # before and after -------------------------------------------------------------------------------------------------

    def _choose_target(self) -> None:
        targets = self._state["project"]["targets"]
        while len(targets) > 1:
            self._console.table(("", ""), [(str(number), name) for number, name in enumerate(targets, 1)])
            name = self._named(self._console.ask("target", self._state["project"]["name"]), targets, "target")
            if name is not None:
                self._act("open", {"target": name})
                return

    def _introduce(self) -> None:
        state = self._state
        files = state["project"]["files"]
        self._console.say(f"{state['project']['name']}: {files['model']} with {files['tcf']}, in {files['bindings']}")
        ports = ports_of(state)
        left = sum(is_open(state, port) for port in ports)
        self._console.say(f"{len(ports)} ports, {left} of them to connect. h lists what can be answered.")

    def _finish(self) -> int:
        """Saves and builds, if that is wanted."""
        self._look()
        if self._state["draft"]["changed"]:
            if not self._console.agree("save?"):
                self._console.say("nothing was saved")
                return LEFT_UNSAVED
            if not self._save():
                return LEFT_UNSAVED
            self._console.say(f"saved {self._state['project']['files']['bindings']}")
        if any(problem["severity"] == "error" for problem in self._state["diagnostics"]):
            self._console.say("there are mistakes: nothing can be built yet")
            return 1
        if not self._console.agree("build?"):
            return 0
        try:
            return 0 if build(self._session, self._console) else 1
        except Refused as problem:
            self._say_refused(problem)
            return 1

    def _save(self) -> bool:
        conflict = self._state["draft"]["conflict"]
        if conflict is None:
            return self._act("save", {})
        self._console.say(f"error: {conflict['message']}")
        if self._console.agree("save anyway, over what others have written?", "n"):
            return self._act("save", {"anyway": True})
        return False

    def _leave(self) -> None:
        """Asks where something would be lost; raises Left."""
        if not self._state["draft"]["changed"]:
            raise Left
        if not self._console.agree("there are changes that are not saved: leave without them?", "n"):
            return
        raise Left

    # one port after the other -----------------------------------------------------------------------------------------

    def _ask_ports(self, wanted: Sequence[Port], ports: Sequence[Port]) -> None:
        """Asks for each of ``wanted``; ``b`` leads to those before, in the order of all ``ports``."""
        queue = list(wanted)
        while queue:
            port = queue[0]
            answer = self._ask(port)
            if answer == "b":
                before = ports[: ports.index(port)]
                if before:
                    queue.insert(0, before[-1])
                else:
                    self._console.say("this is the first port")
            elif answer == "q":
                self._leave()
            elif answer == "e":
                return
            elif self._answered(port, answer):
                queue.pop(0)

    def _ask(self, port: Port) -> str:
        """What is answered for a port; Enter gives what is proposed or is there already, or ""."""
        ports = ports_of(self._state)
        self._console.say()
        number = [other.name for other in ports].index(port.name) + 1
        self._console.fill(
            f"{number}/{len(ports)} {port.title}" + (f": {port.description}" if port.description else "")
        )
        names = self._state["candidates"].get(port.name, ())
        self._console.items([f"{number} {name}" for number, name in enumerate(names, 1)] or [NONE_FITS], "    ")
        default = self._state["proposals"].get(port.name, "")
        if not is_open(self._state, port):
            default = wire_text(self._state, port)
        answer = self._console.ask(f"{port.name} {port.arrow}", default)
        return "" if answer == default and not is_open(self._state, port) else answer

    def _answered(self, port: Port, answer: str) -> bool:
        """Does what was answered; whether the next port is due."""
        if not answer:
            return True  # stays as it is
        if answer in self._commands:
            return self._commands[answer](port)
        if answer in ("-", UNCONNECTED):
            if port.direction == "input":
                self._console.say("an input needs a value: connect it, or press Enter to leave it open for now")
                return False
            return self._connect(port, [])
        names = self._references(port, answer)
        return names is not None and self._connect(port, [{"reference": name} for name in names])

    def _references(self, port: Port, answer: str) -> list[str] | None:
        """What a list of numbers and names means, or None after saying what is wrong."""
        candidates = list(self._state["candidates"].get(port.name, ()))
        every = [offered["reference"] for component in self._state["components"] for offered in component["ports"]]
        names = []
        for word in (word.strip() for word in answer.split(",")):
            if word.isdecimal() and 0 < int(word) <= len(candidates):
                name: str | None = candidates[int(word) - 1]
            elif word in every:  # one that does not fit is refused in the command line's words
                name = word
            else:
                name = self._named(word, candidates, "candidate")
            if name is None:
                return None
            names.append(name)
        return names

    def _named(self, word: str, names: Sequence[str], what: str) -> str | None:
        """The one of ``names`` that is called or begins with ``word``, or has it as its number."""
        fitting = [name for name in names if name == word] or [name for name in names if name.startswith(word)]
        if not fitting and word.isdecimal() and 0 < int(word) <= len(names):
            return names[int(word) - 1]
        if len(fitting) == 1:
            return fitting[0]
        self._console.fill(f"which one: {', '.join(fitting)}?" if fitting else f"there is no {what} '{word}'")
        return None

    def _connect(self, port: Port, ends: list[dict[str, Any]]) -> bool:
        return self._act("connect", {"port": port.name, "ends": ends}, port)

    # commands; each says whether the next port is due -----------------------------------------------------------------

    def _help(self, port: Port) -> bool:
        self._console.say(HELP)
        return False

    def _explain(self, port: Port) -> bool:
        self._console.table(("", "component", "what it is"), candidate_rows(self._state, port))
        return False

    def _show(self, port: Port | None) -> bool:
        self._console.table(("port", "", "component", "where"), wire_rows(self._state))
        return False

    def _undo(self, port: Port | None) -> bool:
        before = self._state["wires"]
        if self._act("undo", {}):
            after = self._state["wires"]
            changed = [other for other in ports_of(self._state) if before.get(other.name) != after.get(other.name)]
            for other in changed:
                self._console.say(f"undone: {other.name} {other.arrow} {wire_text(self._state, other)}")
        return False

    def _disconnect(self, port: Port) -> bool:
        if is_open(self._state, port):
            self._console.say(f"{port.name} is open already")
        else:
            self._act("disconnect", {"port": port.name}, port)
        return False

    def _convert(self, port: Port) -> bool:
        """Asks for a component and what to do with its values."""
        ends = self._state["wires"].get(port.name) or []
        now = ends[0] if len(ends) == 1 else {}
        answer = self._console.ask("component", now.get("reference") or self._state["proposals"].get(port.name, ""))
        names = self._references(port, answer) if answer else None
        if names is None or len(names) != 1:
            return False
        self._console.say("Values are multiplied by scale, then offset is added, then limits hold.")
        end: dict[str, Any] = {"reference": names[0]}
        for key, example in (("scale", "0.5 or 1/4"), ("offset", "-1.5"), ("unit", "deg")):
            end[key] = _cleared(self._console.ask(f"{key}, such as {example}", now.get(key, "")))
        limits = " ".join(now.get("limits") or ())
        words = _cleared(self._console.ask("limits, such as -1 1", limits)).replace(",", " ").split()
        if words:
            end["limits"] = words
        return self._connect(port, [end])

    # the session ------------------------------------------------------------------------------------------------------

    def _act(self, action: str, body: dict[str, Any], port: Port | None = None) -> bool:
        """Does something, and says what comes of it; whether it was done."""
        self._look()
        before = {_key(problem) for problem in self._state["diagnostics"]}
        try:
            self._state = self._session.act(action, body)
        except Refused as problem:
            self._say_refused(problem)
            self._state = self._session.state()
            return False
        self._say_messages(
            problem
            for problem in self._state["diagnostics"]
            if (_key(problem) not in before or (port is not None and problem["port"] == port.name))
            and problem["id"] not in OF_OPEN_PORTS
        )
        return True

    def _look(self) -> None:
        """Says what was edited outside meanwhile."""
        self._state = self._session.wait(self._state["version"], 0)
        external = self._state["draft"]["external"] or ""
        if external and external != self._told:
            self._console.fill(f"note: {external}")
        self._told = external

    def _say_messages(self, problems: Iterable[State]) -> None:
        for problem in problems:
            say_message(problem, self._session, self._console)

    def _say_refused(self, problem: Refused) -> None:
        self._console.fill(f"error: {problem.message}")
        if problem.hint:
            self._console.fill(f"hint: {problem.hint}")


def _cleared(answer: str) -> str:
    """``-`` takes away what stood there."""
    return "" if answer == "-" else answer


def _key(problem: State) -> tuple[object, ...]:
    return problem["id"], problem["file"], problem["message"]
