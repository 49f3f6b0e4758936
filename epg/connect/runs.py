# SPDX-License-Identifier: Apache-2.0
"""What a session runs, one at a time: builds, simulations, programs, and writing to boards.  The last are kept."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from epg.connect.activity import Activity
from epg.connect.body import Refused
from epg.connect.build.build_run import Build, configuration_of
from epg.connect.build.consent import Question, question_about, question_about_program
from epg.connect.places import Places
from epg.connect.projects import Job
from epg.connect.run.find_simulation import Simulation, simulations_of
from epg.connect.run.flash import Boards, FlashRun, boards_for
from epg.connect.run.live_comparison import ComparisonRun, Driven, comparison_commands
from epg.connect.run.program import ProgramRun, command_of, port_of
from epg.connect.run.simulate import SimulationRun, commands_of
from epg.generator.check.configuration import Configuration
from epg.generator.resolve.application import Application
from epg.generator.source import Span
from epg.generator.system import here

START = 10.0
"""Seconds that a program gets to open its console."""


class Runs:
    """Starts, cancels and shows activities, one at a time.

    ``changed`` is called, by any thread, when there is something new to show.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._build, self._simulation = Build(changed), SimulationRun(changed)
        self._program, self._flash = ProgramRun(changed), FlashRun(changed)
        self._comparison = ComparisonRun(changed)
        self._boards: Boards | None = None
        self._questions: dict[str, dict[str, Any] | None] = {}

    @property
    def _activities(self) -> dict[str, Activity]:
        return {
            "build": self._build,
            "simulation": self._simulation,
            "program": self._program,
            "flash": self._flash,
            "comparison": self._comparison,
        }

    @property
    def must_end(self) -> bool:
        """True while something runs that ends by itself, and that the user can expect to be completed."""
        return any(activity.is_running for activity in self._activities.values() if activity is not self._program)

    def check_idle(self, beside: str = "") -> None:
        """Raises Refused while an activity runs, other than ``beside``."""
        for name, activity in self._activities.items():
            if activity.is_running and name != beside:
                what = {"flash": "a board is being written"}.get(name, f"a {name} is running")
                raise Refused(what, "wait for it, or cancel it", 409)

    def ask(
        self, job: Job, configuration: Configuration | None, agreed: str, *, anyway: bool = False
    ) -> dict[str, Any] | None:
        """The question that the user must agree to before the build; None if there is no question left.

        ``agreed`` is the key of a question that the user has answered with yes.
        """
        return self._ask("build", question_about(job, configuration, anyway=anyway), agreed, {})

    def ask_to_simulate(
        self, simulation: Simulation, agreed: str, wires: Mapping[str, str], *, anyway: bool = False
    ) -> dict[str, Any] | None:
        """The question before a simulation, as :meth:`ask`: its build and its run start programs.

        ``wires`` are proposed wires to which the user must agree, too.
        """
        configuration = configuration_of(simulation.job.request)
        question = question_about(simulation.job, configuration, commands_of(simulation), anyway=anyway)
        return self._ask("simulation", question, agreed, wires)

    def _ask(
        self, name: str, question: Question | None, agreed: str, wires: Mapping[str, str]
    ) -> dict[str, Any] | None:
        if question is not None and question.key == agreed:
            question.agree()
            question = None
        asked = {"folder": "", "commands": (), "programs": (), "key": ""} if question is None else question.data()
        self._questions[name] = {**asked, "wires": dict(wires)} if question is not None or wires else None
        return self._questions[name]

    def start(self, job: Job, leave_program: Callable[[], None], *, anyway: bool = False) -> None:
        """Configures and builds ``job``.  Raises Refused while another activity runs, other than a program.

        If the system locks the program's file, it ends first, after ``leave_program``, which ends a connection with it.
        """
        self.check_idle(beside="program")
        self._build = Build(self._changed)
        self._build.start(job, anyway=anyway, first=lambda: self._unlock_program(leave_program))

    def _unlock_program(self, leave: Callable[[], None]) -> str:
        if not (here.LOCKS_PROGRAMS and self._program.is_running):
            return ""
        name = Path(self._program.shown["program"]).name
        why = f"stopped '{name}', because Windows does not let a running program be replaced"
        leave()
        return self._program.stop(why)

    def simulate(self, simulation: Simulation, *, anyway: bool = False) -> None:
        """Builds and runs a simulation.  Raises Refused while another activity runs."""
        self.check_idle()
        self._simulation = SimulationRun(self._changed)
        self._simulation.start(simulation, anyway=anyway)

    def ask_to_compare(self, simulation: Simulation, agreed: str, *, anyway: bool = False) -> dict[str, Any] | None:
        """The question before a comparison, as :meth:`ask`."""
        configuration = configuration_of(simulation.job.request)
        question = question_about(simulation.job, configuration, comparison_commands(simulation), anyway=anyway)
        return self._ask("comparison", question, agreed, {})

    def compare(self, simulation: Simulation, driven: Driven, by: Sequence[str], *, anyway: bool = False) -> None:
        """Compares a running target with its simulation.  Raises Refused while another activity runs.

        The target can be the program that runs.
        """
        self.check_idle(beside="program")
        self._comparison = ComparisonRun(self._changed)
        self._comparison.start(simulation, driven, by, anyway=anyway)

    @property
    def compared(self) -> dict[str, Any]:
        """The curves of the last comparison.  Raises Refused."""
        if self._comparison.compared is None:
            raise Refused("nothing has been compared", "compare first", 409)
        return self._comparison.compared

    def run_program(self, path: str, agreed: str, *, console: bool) -> None:
        """Runs a product of the last build in real time, if the user has agreed.  Raises Refused.

        With a ``console``, the page can connect with it.
        """
        self.check_idle()
        product = self._product(path)
        if not product["runs"]:
            raise Refused(f"{Path(path).name} does not run on this computer", status=409)
        program = Path(path)
        port = port_of(program) if console else None
        question = question_about_program(command_of(program, port), program.parent)
        if self._ask("program", question, agreed, {}) is None:
            self._program = ProgramRun(self._changed)
            self._program.start(program, port)

    def run_with_console(self, program: Path) -> Path:
        """Runs a program that the user has named on the command line.  Returns the port of its console.

        Raises Refused.
        """
        self.check_idle()
        self._program = ProgramRun(self._changed)
        self._program.start(program, port_of(program))
        end = time.monotonic() + START
        while self._program.console is None and self._program.is_running and time.monotonic() < end:
            time.sleep(0.02)
        if not self._program.is_running:
            problem = self._program.state()["messages"][0]
            raise Refused(problem["message"], problem["hint"], 409)
        if self._program.console is None:
            raise Refused(f"'{program.name}' has no console after {START:.0f} s", "name a program of this target", 409)
        return self._program.console

    def find_boards(self, job: Job, application: Application) -> None:
        """Looks for boards to which the products of the last build can be written.  Raises Refused."""
        self.check_idle()
        made = [Path(each["path"]) for each in self._build.state()["products"]]
        if not made:
            raise Refused("there is no file for the board yet", "generate first", 409)
        self._boards = boards_for(job, application, made)

    def flash(self, id: str, *, replace: bool) -> None:
        """Writes the product to the board ``id``, which :meth:`find_boards` has found and the user has confirmed."""
        self.check_idle()
        boards = self._boards or Boards()
        chosen = [board for board in boards.found if board.id == id]
        if not chosen:
            raise Refused(f"there is no board '{id}'", "look for boards again", 409)
        self._boards = None
        self._flash = FlashRun(self._changed)
        self._flash.start(boards, chosen[0], replace=replace)

    def download(self, path: str) -> bytes:
        """The contents of a product of the last build.  Raises Refused for other files."""
        try:
            return Path(self._product(path)["path"]).read_bytes()
        except OSError as error:
            raise Refused(f"cannot read {path}: {error.strerror}", "generate again", 404) from None

    def _product(self, path: str) -> dict[str, Any]:
        chosen = [each for each in self._build.state()["products"] if each["path"] == path]
        if not chosen:
            raise Refused(f"the last build has not made '{path}'", "generate again", 404)
        return dict(chosen[0])

    @property
    def ends_program(self) -> bool:
        """True if :meth:`cancel` ends the program that runs."""
        return self._program.is_running and not self.must_end

    def cancel(self) -> None:
        """Cancels the running activity; of a program and what runs beside it, the latter."""
        self._cancel_all(beside="program" if self.must_end else "")

    def close(self) -> None:
        """Cancels all activities, and waits at most 10 s for their ends."""
        self._cancel_all()
        for activity in self._activities.values():
            activity.wait(10)

    def _cancel_all(self, beside: str = "") -> None:
        for name, activity in self._activities.items():
            if activity.is_running and name != beside:
                activity.cancel()

    def forget(self) -> None:
        self._build, self._simulation = Build(self._changed), SimulationRun(self._changed)
        self._program, self._flash = ProgramRun(self._changed), FlashRun(self._changed)
        self._comparison = ComparisonRun(self._changed)
        self._boards = None
        self._questions = {}

    def state(self, places: Places | None) -> dict[str, Any]:
        """The state of each activity for the page.  A message about the bindings gets the port that it is about."""
        states = {}
        for name, activity in self._activities.items():
            state = activity.state() | {"ask": self._questions.get(name)}
            for message in state["messages"] if places is not None else ():
                assert places is not None
                message["port"] = places.port_at(Span(message["file"], message["line"], message["column"]))
            states[name] = state
        states["flash"]["boards"] = self._boards.data() if self._boards is not None else None
        return states

    def lines(self, name: str, start: int) -> list[str]:
        """The printed lines of an activity from line ``start`` on.  Raises Refused."""
        activity = self._activities.get(name)
        if activity is None:
            raise Refused(f"there is no log of '{name}'", status=404)
        return activity.lines(start)

    @property
    def port(self) -> str:
        """The port of the program that runs; empty if there is none."""
        return str(self._program.shown["port"]) if self._program.is_running else ""

    @property
    def plot(self) -> str:
        """The picture of the last simulation; empty if there is none."""
        return self._simulation.plot


def find_simulation(job: Job, name: str) -> Simulation:
    """The simulation ``name`` of a target; the first one if ``name`` is empty.  Raises Refused."""
    simulations = simulations_of(job)
    if not simulations.found:
        raise Refused(simulations.problem, simulations.hint, 409)
    chosen = [each for each in simulations.found if name in ("", each.name)]
    if not chosen:
        raise Refused(f"there is no simulation '{name}'", status=404)
    return chosen[0]
