# SPDX-License-Identifier: Apache-2.0
"""``epg connect --terminal``: asks one question after the other, for users without a browser and for scripts.

>>> # status = run(session, sys.stdin, sys.stdout)

Answers may come from a file: each question takes one line.
"""

from __future__ import annotations

from typing import TextIO

from epg.connect.session import Refused, Session
from epg.connect.terminal.build_progress import ask_to_build, build
from epg.connect.terminal.console import Console, Ended
from epg.connect.terminal.create import Left, create_project
from epg.connect.terminal.message import say_refused
from epg.connect.terminal.port_questions import Ports
from epg.connect.terminal.talk import Talk
from epg.connect.terminal.text import is_open, ports_of

LEFT_UNSAVED, INTERRUPTED = 1, 130


def run(session: Session, input: TextIO, output: TextIO) -> int:
    """Asks until the user is done.  Returns the exit status: 0; 1 for an error or unsaved changes; 130 for Ctrl-C."""
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
        lost = session.state()["phase"] == "choose" or session.has_changes
        console.say("the input has ended" + (": nothing was saved" if lost else ""))
        return LEFT_UNSAVED if lost else 0
    except KeyboardInterrupt:
        console.say()
        return INTERRUPTED
    finally:
        session.runs.close()


class _Dialog:
    """The questions about one target."""

    def __init__(self, session: Session, console: Console) -> None:
        self._talk, self._console = Talk(session, console), console
        self._ports = Ports(self._talk)

    def run(self) -> int:
        self._choose_target()
        self._introduce()
        if not self._talk.state["editable"]:
            self._talk.say_messages(self._talk.state["diagnostics"])
            self._console.say(self._talk.state["why_not"])
            return 1
        ports = ports_of(self._talk.state)
        self._ports.ask([port for port in ports if is_open(self._talk.state, port)], ports)
        shown = None
        while True:
            if shown != self._talk.state["wires"]:
                shown = self._talk.state["wires"]
                self._console.say()
                self._ports.show(None)
                self._talk.say_messages(self._talk.state["diagnostics"])
            answer = self._console.ask("port to change, u to undo, q to quit, Enter to continue", "")
            if not answer:
                return self._finish()
            if answer == "q":
                self._talk.leave()
            elif answer == "u":
                self._ports.undo(None)
            elif answer == "s":
                shown = None
            else:
                named = self._talk.named(answer, [port.name for port in ports], "port")
                if named is not None:
                    self._ports.ask([port for port in ports if port.name == named], ports)

    # Questions before and after those about ports ---------------------------------------------------------------------

    def _choose_target(self) -> None:
        """Lets the user choose one of several targets.  A system is shown first, with its messages."""
        state = self._talk.state
        targets = state["project"]["targets"]
        usual = targets[0] if state["phase"] == "system" else state["project"]["name"]
        if state["phase"] == "system":
            self._console.say(f"System {state['project']['name']}")
            for connection in state["system"]["connections"]:
                ends = [f"{end['target']}/{end['port']}" for end in (connection["from"], connection["to"])]
                self._console.say(f"  {' -> '.join(ends)}  {connection['sent']}".rstrip())
            self._talk.say_messages(state["diagnostics"])
        while len(targets) > 1 or self._talk.state["phase"] == "system":
            self._console.table(("", ""), [(str(number), name) for number, name in enumerate(targets, 1)])
            name = self._talk.named(self._console.ask("target", usual), targets, "target")
            if name is not None:
                self._talk.act("open", {"target": name})
                return

    def _introduce(self) -> None:
        state = self._talk.state
        files = state["project"]["files"]
        self._console.say(f"{state['project']['name']}: {files['model']} with {files['tcf']}, in {files['bindings']}")
        ports = ports_of(state)
        left = sum(is_open(state, port) for port in ports)
        self._console.say(f"{len(ports)} ports, {left} of them to connect. h lists the possible answers.")

    def _leave_out(self) -> None:
        """Offers to remove the parts of the robot that no port uses, if this corrects all errors."""
        unused = self._talk.state["unused"]
        errors = {each["id"] for each in self._talk.state["diagnostics"] if each["severity"] == "error"}
        question = f"no port uses {', '.join(unused)}: leave them out?"
        if unused and errors == {"needs-bound"} and self._console.agree(question):
            self._talk.act("leave_out", {})

    def _finish(self) -> int:
        """Saves and builds, if the user agrees.  Returns the exit status."""
        self._talk.look()
        self._leave_out()
        if self._talk.state["draft"]["changed"]:
            if not self._console.agree("save?"):
                self._console.say("nothing was saved")
                return LEFT_UNSAVED
            if not self._save():
                return LEFT_UNSAVED
            self._console.say(f"saved {self._talk.state['project']['files']['bindings']}")
        if any(problem["severity"] == "error" for problem in self._talk.state["diagnostics"]):
            self._console.say("there are errors: the project cannot be built")
            return 1
        agreed = ask_to_build(self._talk.session, self._console)
        if agreed is None:
            return 0 if not self._talk.session.missing_tools()[0] else 1
        try:
            return 0 if build(self._talk.session, self._console, agreed) else 1
        except Refused as problem:
            say_refused(problem, self._console)
            return 1

    def _save_with_errors(self) -> bool:
        """Saves although other targets then have errors, if the user agrees.  They are listed first."""
        asked = self._talk.session.state()["ask"]
        for each in asked:
            for error in each["errors"]:
                self._console.say(f"{each['target']}: error: {error['message']}")
        return (
            bool(asked)
            and self._console.agree("save with these errors?", "n")
            and self._talk.act("save", {"agreed": True})
        )

    def _save(self) -> bool:
        conflict = self._talk.state["draft"]["conflict"]
        if conflict is None:
            return self._talk.act("save", {}) or self._save_with_errors()
        self._console.say(f"error: {conflict['message']}")
        if self._console.agree("save anyway, and overwrite the other program's changes?", "n"):
            return self._talk.act("save", {"anyway": True})
        return False
