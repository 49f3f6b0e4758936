# SPDX-License-Identifier: Apache-2.0
"""A session of ``epg connect``: the state that is shown, and all actions of the user.

Page and terminal call the same two functions: :meth:`Session.wait` returns the state, :meth:`Session.act` changes it.
After each change the whole state is made again from the files and the draft, so it cannot disagree with them.

>>> # session = Session(find_jobs(Path("examples/jiwy"), diagnostics))
>>> # session.act("connect", {"port": "pwm_pan", "ends": [{"reference": "pwm_tilt"}]})["diagnostics"]
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import epg
from epg.connect.body import Body, Refused, boolean, number, text
from epg.connect.build.plan import make_plan
from epg.connect.configurations import Configurations
from epg.connect.creation import create
from epg.connect.editor import Editor
from epg.connect.edits import EDITS
from epg.connect.excerpt import excerpt
from epg.connect.files import Unsavable
from epg.connect.json_data import State
from epg.connect.other_targets import new_errors, readers
from epg.connect.overview import Overview
from epg.connect.pictures import draw
from epg.connect.pinout import draw_pinout, options_view
from epg.connect.projects import Job, find_jobs, system_jobs
from epg.connect.run.find_simulation import simulations_of
from epg.connect.run.live import Live, built_hash
from epg.connect.runs import Runs, find_simulation
from epg.connect.start import Start
from epg.connect.targets import Targets
from epg.connect.view import diagnostic_view, proposals_of
from epg.edit.bindings import CannotEdit
from epg.generator.check.communication import CONSOLE
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span

__all__ = ["Refused", "Session"]

LOOK = 0.5
"""Seconds between two looks at the files while a caller waits for a change."""


class Session:
    """Shows one target of ``jobs`` at a time, or the ``system`` that they are part of.

    Without jobs, the user first chooses a target for ``model``.

    All methods can be called by any thread.
    """

    def __init__(
        self,
        jobs: Sequence[Job],
        *,
        folder: Path | None = None,
        model: Path | None = None,
        system: Path | None = None,
        user_roots: Sequence[Path] = (),
    ) -> None:
        """``folder`` is that of the project with ``jobs``: they are searched again when its CMakeLists.txt changes.

        With the file of a ``system``, the session begins with it, or with the first of ``jobs``.
        """
        self.ended = threading.Event()
        self.opens_live = False  # the page begins with the tab Live
        self._changed = threading.Condition(threading.RLock())
        self._version = 0
        self._looked = 0.0
        self._outdated = ""  # the name of a file that names the targets, and has changed since the open one was read
        self._user_roots = tuple(user_roots or (jobs[0].request.user_roots if jobs else ()))
        self._targets = self._find_targets(jobs, folder, system)
        self._configurations = Configurations(self._user_roots)
        self._overview = Overview(system, self._user_roots) if system is not None else None
        self._start = Start(model, self._configurations.catalog) if model is not None and not jobs else None
        self._editor = Editor(jobs[0]) if jobs else None
        self._simulations: tuple[Job, State | None] | None = None
        self.runs = Runs(self._bump)
        self.live = Live(self._bump)
        self._actions: dict[str, Callable[[Body], None]] = {
            "save": self._save,
            "reload": self._reload,
            "choose": self._choose,
            "open": self._open,
            "overview": self._show_overview,
            "generate": self._generate,
            "simulate": self._simulate,
            "flash": self._flash,
            "compare": self._compare,
            "run": self._run,
            "done": lambda body: self.ended.set(),
        }
        self._unlocked: dict[str, Callable[[Body], None]] = {
            "create": self._create,
            "cancel": self._cancel,
        }
        self._shown: State = {}
        self._readers: tuple[Editor, list[str]] | None = None
        self._publish()
        threading.Thread(target=self._list_configurations, daemon=True).start()

    @property
    def actions(self) -> tuple[str, ...]:
        """The names that :meth:`act` takes."""
        return (*EDITS, *self._actions, *self._unlocked)

    def state(self) -> State:
        """The present state, without a look at the files."""
        with self._changed:
            places = self._editor.loaded.places if self._editor is not None else None
            shown = {"version": self._version, "epg": epg.__version__, **self._shown}
            return shown | self.runs.state(places) | {"live": self._live_state()}

    def _live_state(self) -> State:
        shown = {"opens": self.opens_live, "console": self.without_console is None}
        return self.live.state(self.runs.port) | shown

    def wait(self, after: int, timeout: float) -> State:
        """The state, once its version differs from ``after``, the session ends, or ``timeout`` seconds have passed."""
        until = time.monotonic() + timeout
        while True:
            self._look()
            with self._changed:
                left = until - time.monotonic()
                if self._version != after or left <= 0 or self.ended.is_set():
                    return self.state()
                self._changed.wait(min(LOOK, left))

    def act(self, action: str, body: Body) -> State:
        """Does ``action`` and returns the state after it.

        Raises :class:`Refused`.  Nothing has changed then, except that saving may have written one of the two files.
        """
        try:
            if action in self._unlocked:
                self._unlocked[action](body)
            elif action in EDITS or action in self._actions:
                self._look(at_once=True)
                with self._changed:
                    if action in EDITS:
                        EDITS[action](self._opened(), body)
                    else:
                        self._actions[action](body)
                    self._publish()
            else:
                raise Refused(f"there is no action '{action}'", status=404)
        except CannotEdit as problem:
            raise Refused(str(problem)) from None
        except Unsavable as problem:
            self._publish()  # one of the two files may have been saved
            raise Refused(str(problem), status=409) from None
        return self.state()

    def pinout(self, component: str, signal: str) -> str:
        """The board's drawing for the page: with ``component``, it shows the contacts that can have its ``signal``."""
        with self._changed:
            editor = self._opened()
            title = editor.job.request.name
            svg = draw_pinout(editor.loaded, title, (component, signal) if component else None, for_page=True)
        if svg is None:
            raise Refused("there is no such picture", "the messages show the reason", 404)
        return svg

    def pin_options(self, component: str, signal: str) -> list[dict[str, Any]]:
        """The pins of the board for a signal: those that fit, and the reasons why others do not.  Raises Refused."""
        with self._changed:
            return options_view(self._opened().loaded, (component, signal))

    def picture(self, name: str, configuration: str = "") -> str:
        """The picture ``name`` of the open target as SVG, or the wiring of ``configuration``.  Raises Refused."""
        editor = self._editor
        svg = None
        if name == "simulation":
            svg = self.runs.plot or None
        elif configuration:
            svg = self._configurations.picture(configuration) if name == "wiring" else None
        elif editor is None and self._overview is not None:
            svg = self._overview.picture() if name == "system" else None
        elif editor is not None:
            svg = draw(editor.loaded, name, editor.job.request.name)
        if svg is None:
            raise Refused("there is no such picture", "the messages show the reason", 404)
        return svg

    def source(self, file: str, line: int) -> dict[str, Any]:
        """The lines around ``line`` of a file that a message names.  Raises Refused for other files."""
        editor = self._editor
        job = editor.job if editor is not None else None
        folder = (job.build_dir or job.source_dir if job is not None else None) or Path()
        return excerpt(self.state(), folder, editor.draft.drafts() if editor is not None else {}, file, line)

    def missing_tools(self) -> tuple[list[dict[str, Any]], bool]:
        """Messages about tools that a build needs and that are missing; True if a build can be tried without them."""
        with self._changed:
            editor = self._opened()
            plan = make_plan(editor.job, editor.loaded.parts.configuration, run=False)
            return [message.data() for message in plan.missing], plan.can_try

    def build_question(self, *, anyway: bool = False) -> dict[str, Any] | None:
        """The question that the user must agree to before a build; None if there is none.

        The action "generate" with the question's key as "run" agrees to it.
        """
        with self._changed:
            return self._ask("", anyway=anyway)

    def go_live(self, body: Body) -> None:
        """Connects with the target behind the port "path".  The hash of the last build tells whether it is this one.

        "key" is the key of a console by UDP, if the user has typed it.
        """
        editor = self._editor
        expected = built_hash(editor.job) if editor is not None else ""
        roots = editor.job.request.roots if editor is not None else ()
        path, key = Path(text(body, "path")), text(body, "key", "")
        if key:
            self.live.give_key(path, key)
        self.live.connect(path, expected, int(number(body, "baud", 115200)), roots)

    def run_live(self, program: Path) -> None:
        """Runs ``program`` of the open target in real time, and connects with it.  It is not enabled.  Raises Refused.

        The program ends with the session.
        """
        job = self._opened().job
        self.live.connect(self.runs.run_with_console(program), built_hash(job), roots=job.request.roots)

    @property
    def without_console(self) -> Span | None:
        """The place in the ``.tcf`` of an open target that has no console, with which :attr:`live` could connect."""
        configuration = self._editor.loaded.parts.configuration if self._editor is not None else None
        if configuration is None or any(used.name == CONSOLE for used in configuration.communication.middlewares):
            return None
        return configuration.communication.span

    @property
    def has_changes(self) -> bool:
        """True if there are unsaved changes."""
        return self._editor is not None and self._editor.draft.changed

    # actions of the user

    def _save(self, body: Body) -> None:
        editor = self._opened()
        if not boolean(body, "agreed"):
            self._check_others(editor)
        editor.save(anyway=boolean(body, "anyway"))
        if self._targets.look():  # EPG itself has written a CMakeLists.txt: the project can be built in another way now
            editor.job = self._targets.find(editor.job.request.name) or editor.job
        self._open_anew()

    def _others(self, editor: Editor) -> list[Job]:
        return [job for job in self._targets.jobs if job.request.name != editor.job.request.name]

    def _shared(self, editor: Editor) -> list[str]:
        """The other targets that read the project's own ``.tcf``, as they were when the target was opened."""
        if self._readers is None or self._readers[0] is not editor:
            found = readers(editor.draft.tcf.path, self._others(editor)) if editor.owns_tcf else []
            self._readers = editor, [job.request.name for job in found]
        return self._readers[1]

    def _check_others(self, editor: Editor) -> None:
        """Raises Refused if saving makes errors in other targets of the project, which the state then lists."""
        texts = {after.path: after.text or "" for _, after in editor.draft.unsaved()}
        errors = new_errors(texts, self._others(editor))
        editor.ask = [
            {"target": name, "errors": [diagnostic_view(each) for each in found]} for name, found in errors.items()
        ]
        if errors:
            self._publish()
            hint = "correct them, or save although these targets then have errors"
            raise Refused(f"saving makes errors in other targets: {', '.join(errors)}", hint, 409)

    def _reload(self, body: Body) -> None:
        self._opened().reload()
        self._open_anew()

    def _choose(self, body: Body) -> None:
        """Moves the target to another one, with all changes of :meth:`move` in one step."""
        name = self._choice(text(body, "configuration"))
        if name != self._opened().project().chosen:
            self._opened().edit(self._opened().plan_move(name).operation)

    def _choice(self, name: str) -> str:
        """The name of a configuration or target that can be chosen.  Raises Refused."""
        choice = self._configurations.find(name)
        if choice is None:
            raise Refused(f"there is no configuration '{name}'", status=404)
        reason = self._opened().project().reason(choice)
        if reason:
            raise Refused(f"'{name}' cannot be chosen here", reason, 409)
        return name

    def move(self, name: str) -> dict[str, Any]:
        """The list of changes that the action "choose" would make for a configuration or a target.  Raises Refused."""
        with self._changed:
            try:
                return self._opened().plan_move(self._choice(name)).data()
            except CannotEdit as problem:
                raise Refused(str(problem)) from None

    def _open(self, body: Body) -> None:
        name = text(body, "target")
        job = self._targets.find(name)
        if job is None:
            raise Refused(f"there is no target '{name}'", status=404)
        if self._editor is not None and name == self._editor.job.request.name:
            return
        self._check_left()
        self._editor = Editor(job)

    def _show_overview(self, body: Body) -> None:
        """Closes the open target of a system, and shows the system."""
        if self._overview is None:
            raise Refused("this target is not part of a system", status=409)
        if self._editor is not None:
            self._check_left()
            self._overview.load()
            self._editor, self._outdated = None, ""

    def _check_left(self) -> None:
        """Raises Refused if the open target cannot be closed now."""
        if self.has_changes:
            raise Refused("there are unsaved changes", "save or undo them first", 409)
        self.runs.check_idle()
        self.runs.forget()

    def _create(self, body: Body) -> None:
        start = self._start
        if start is None:
            raise Refused("the project already exists", status=409)
        jobs = create(body, start.path, self._user_roots)
        with self._changed:
            self._targets = self._find_targets(jobs, jobs[0].source_dir)
            self._editor, self._start = Editor(jobs[0]), None
            self._publish()

    def _generate(self, body: Body) -> None:
        self._check_ready(beside="program")
        self._save_project()
        anyway = boolean(body, "anyway")
        if self._ask(text(body, "run", ""), anyway=anyway) is None:
            self._save({})
            self.runs.start(self._opened().job, self._leave_program, anyway=anyway)

    def _simulate(self, body: Body) -> None:
        """Builds the target for this computer, and runs it through a scenario in simulated time.

        If only wires are missing that EPG proposes, the user can agree to them, too: "accept".
        """
        self.runs.check_idle()
        wires = self._missing_wires()
        if not wires:
            self._check_ready()
        self._save_project()
        simulation = find_simulation(self._opened().job, text(body, "simulation", ""))
        anyway, accepted = boolean(body, "anyway"), boolean(body, "accept")
        left = {} if accepted else wires
        ask = self.runs.ask_to_simulate(simulation, text(body, "run", ""), left, anyway=anyway)
        if ask is not None:
            return
        if wires:
            EDITS["accept"](self._opened(), {})
            self._publish()
            self._check_ready()
        self._save({})
        self.runs.simulate(simulation, anyway=anyway)

    def _compare(self, body: Body) -> None:
        """Gives the setpoints of the running target since its enabling to its simulation, and compares both."""
        self._check_ready(beside="program")
        driven = self.live.driven()
        simulation = find_simulation(self._opened().job, text(body, "simulation", ""))
        anyway = boolean(body, "anyway")
        if self.runs.ask_to_compare(simulation, text(body, "run", ""), anyway=anyway) is None:
            application = self._opened().loaded.parts.application
            wires = application.inputs if application is not None else ()
            by = [f"inputs.{wire.port.name}" for wire in wires if wire.component.kind.communication == "subscribe"]
            self._save({})
            self.runs.compare(simulation, driven, by, anyway=anyway)

    def _run(self, body: Body) -> None:
        self.runs.run_program(text(body, "path"), text(body, "run", ""), console=self.without_console is None)

    def _cancel(self, body: Body) -> None:
        """Cancels the running activity."""
        if self.runs.ends_program:
            self._leave_program()
        self.runs.cancel()

    def _leave_program(self) -> None:
        """Ends the connection with the program that will end, so that the page does not report a lost target."""
        if self.runs.port:
            self.live.leave(Path(self.runs.port))

    def _flash(self, body: Body) -> None:
        """Without "board": looks for boards.  With it: writes the last product to this board."""
        board = text(body, "board", "")
        if board:
            self.runs.flash(board, replace=boolean(body, "replace"))
            return
        application = self._opened().loaded.parts.application
        if application is None:
            raise Refused("the target has errors", "correct the errors in the messages", 409)
        self.runs.find_boards(self._opened().job, application)

    def _missing_wires(self) -> dict[str, str]:
        """The proposed wires, if they correct all errors of the target; else none."""
        proposals = proposals_of(self._opened().loaded)
        errors = [problem for problem in self._shown["diagnostics"] if problem["severity"] == "error"]
        proposed = all(problem["id"] == "unbound-input" and problem["port"] in proposals for problem in errors)
        return proposals if errors and proposed else {}

    def _check_ready(self, beside: str = "") -> None:
        """Raises Refused if the target cannot be built now.  An activity ``beside`` may run."""
        self.runs.check_idle(beside)
        self._opened().check_conflict()
        job = self._opened().job
        if job.simulated and job.source_dir is None:
            assert self._overview is not None
            name = self._overview.path.name
            hint = f"'epg new . --system {name}' writes one, in the folder of {name}"
            raise Refused("this system has no project that could be built", hint, 409)
        count = sum(problem["severity"] == "error" for problem in self._shown["diagnostics"])
        if count:
            what = "is an error" if count == 1 else f"are {count} errors"
            raise Refused(f"there {what}: the project cannot be built", "correct the errors in the messages", 409)

    def _save_project(self) -> None:
        """Saves a move to another target: its CMakeLists.txt is built by other commands, which the user must see."""
        if self._opened().draft.files:
            self._save({})

    def _ask(self, agreed: str, *, anyway: bool) -> dict[str, Any] | None:
        editor = self._opened()
        return self.runs.ask(editor.job, editor.loaded.parts.configuration, agreed, anyway=anyway)

    # making the state

    def _find_targets(self, jobs: Sequence[Job], folder: Path | None, system: Path | None = None) -> Targets:
        """The targets of a session that begins with ``jobs``, in the project or in the system."""
        if system is not None:
            around = folder or system.parent
            return Targets(
                system_jobs(system, around, self._user_roots), lambda: system_jobs(system, around, self._user_roots)
            )
        return Targets(jobs, (lambda: find_jobs(folder, Diagnostics())) if folder is not None else None)

    def _opened(self) -> Editor:
        if self._editor is None and self._overview is not None:
            raise Refused("no target of the system is open", "open a target first", 409)
        if self._editor is None:
            raise Refused("there is no project yet", "choose a target first", 409)
        return self._editor

    def _look(self, *, at_once: bool = False) -> None:
        """Notices edits by other programs: at most twice a second, or with ``at_once`` before a change of the user."""
        with self._changed:
            now = time.monotonic()
            if not at_once and now - self._looked < 0.9 * LOOK:
                return
            self._looked = now
            looked_at = self._editor or self._overview or self._start
            changed = looked_at is not None and looked_at.look()
            file = self._targets.look()
            if file:
                changed = True
                self._outdated = file if self._editor is not None else ""
                self._open_anew()
            if changed:
                self._publish()

    def _open_anew(self) -> None:
        """Opens the target as the changed file defines it, as soon as there are no unsaved changes."""
        editor = self._editor
        if editor is None or not self._outdated:
            return
        if editor.draft.changed:
            editor.external = f"another program changed {self._outdated}: EPG reads it again after you save or reload"
            return
        self._editor = Editor(self._targets.find(editor.job.request.name) or self._targets.jobs[0])
        self._editor.external = f"another program changed {self._outdated}; EPG has read it again"
        self._outdated = ""

    def _publish(self) -> None:
        """Makes the state again from the files and the draft, and wakes all callers of :meth:`wait`."""
        with self._changed:
            if self._editor is not None:
                shown = {"phase": "connect", "create": None, **self._editor.show()}
                shown["project"]["targets"] = self._targets.names
                shown["forms"] = {**shown["forms"], "shared": self._shared(self._editor)}
                shown["project"]["system"] = self._overview.name if self._overview is not None else None
                model, project = self._editor.loaded.parts.model, self._editor.project()
            elif self._overview is not None:
                shown, model, project = self._overview.show(), None, None
                shown["project"]["targets"] = self._targets.names
            else:
                assert self._start is not None
                shown, model, project = self._start.show(), self._start.model, None
            shown["simulations"] = self._found_simulations()
            ready = self._configurations.ready
            ready = ready and shown["phase"] != "system"
            shown["configurations"] = self._configurations.entries(model, project) if ready else []
            self._shown = shown
            self._bump()

    def _found_simulations(self) -> State | None:
        """The simulations of the open target; None while they are searched, which takes some tenths of a second."""
        job = self._editor.job if self._editor is not None else None
        if job is None:
            return None
        if self._simulations is None or self._simulations[0] is not job:
            self._simulations = (job, None)
            threading.Thread(target=self._find_simulations, args=(job,), daemon=True).start()
        return self._simulations[1]

    def _find_simulations(self, job: Job) -> None:
        simulations = simulations_of(job)
        listed = [{"name": each.name, "scenario": str(each.scenario)} for each in simulations.found]
        with self._changed:
            if self._editor is not None and self._editor.job is job:
                self._simulations = (job, {"found": listed, "problem": simulations.problem, "hint": simulations.hint})
                self._publish()

    def _bump(self) -> None:
        with self._changed:
            self._version += 1
            self._changed.notify_all()

    def _list_configurations(self) -> None:
        self._configurations.prepare()
        self._publish()
