# SPDX-License-Identifier: Apache-2.0
"""Builds a target in the background: configures, compiles, and finds the products.

>>> # build = Build(changed=wake_the_page)
>>> # build.start(job); build.state()["products"]
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar

from epg.connect.activity import Activity, Outcome
from epg.connect.build.build_messages import BuildMessage, Messages
from epg.connect.build.build_tools import download_problem, find_tools, missing_tools
from epg.connect.build.plan import Plan, make_plan
from epg.connect.build.products import Made, ask, products
from epg.connect.projects import Job
from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.communication import tools_for
from epg.generator.check.configuration import Configuration
from epg.generator.diagnostics import Diagnostics
from epg.generator.project import Request, load_configuration

PATIENCE = 10.0
"""The longest time in seconds in which the server of a library that the build downloads must answer."""


class Build(Activity):
    """One build.  ``products`` in its state are the files for the user, the most useful ones first.

    A product ``runs`` if it is a program for this computer.
    ``can_try`` is True if CMake was not started because tools are missing that the project may still find.
    """

    more: ClassVar = {"products": (), "can_try": False}

    def start(self, job: Job, *, anyway: bool = False, first: Callable[[], str] = str) -> None:
        """Starts the build of ``job``; ``anyway`` as for :func:`~epg.connect.build.plan.make_plan`.

        ``first`` is done before it, and returns a line for the log, or an empty text.
        """
        self.begin(lambda: self._build(job, anyway, first))

    def _build(self, job: Job, anyway: bool, first: Callable[[], str]) -> Outcome:
        if said := first():
            self.read(said)
        outcome, made = build(self, job, anyway=anyway)
        runs = _runs_here(job)
        listed = [{"path": str(each.path), "what": each.what, "runs": runs} for each in made]
        return Outcome(outcome.state, outcome.messages, {"products": listed, **outcome.more})


def build(activity: Activity, job: Job, *, anyway: bool = False) -> tuple[Outcome, list[Made]]:
    """Builds ``job`` as a part of ``activity``, in its thread.  Returns the products, too."""
    configuration = None if job.simulated else configuration_of(job.request)
    plan = make_plan(job, configuration, anyway=anyway)
    if plan.missing:
        return Outcome("failed", plan.missing, {"can_try": plan.can_try}), []
    unreachable = [] if anyway else _unreachable(activity, job, plan)
    if activity.is_cancelled:
        return Outcome("cancelled"), []
    if unreachable:
        return Outcome("failed", unreachable, {"can_try": True}), []
    messages = Messages((plan.source, plan.build))
    activity.read_messages(messages)
    ask(plan.build)
    for step in plan.steps:
        status = activity.run(step.name, step.command, step.folder, plan.environment, modest=True)
        if activity.is_cancelled:
            return Outcome("cancelled", messages.finish(failed=False)), []
        if status != 0:
            problems = messages.finish(failed=True)
            if step.name == "configure" and configuration is not None:
                problems += _missing_too(job, configuration, plan, problems)
            return Outcome("failed", problems), []
    platform = configuration.target.platform if configuration is not None else None
    made = products(plan.build, job.request.name, platform, job.executables)
    return Outcome("done", messages.finish(failed=False)), made


def _unreachable(activity: Activity, job: Job, plan: Plan) -> list[BuildMessage]:
    """A message for each library that the build would download, and whose server does not answer."""
    problems = []
    for tool in plan.downloads:
        begin = len(activity.lines(0))
        command = ("git", "ls-remote", "--exit-code", tool.fetched, "HEAD")
        environment = {**plan.environment, "GIT_TERMINAL_PROMPT": "0"}
        status = activity.run("download", command, plan.source, environment, patience=PATIENCE)
        if status != 0:
            said = [line for line in activity.lines(begin) if line.strip()]
            problems.append(download_problem(tool, said[-1] if said else "no answer", job.request.roots, plan.cache))
    return problems


def _missing_too(job: Job, configuration: Configuration, plan: Plan, found: list[BuildMessage]) -> list[BuildMessage]:
    """Messages about missing tools that CMake's messages ``found`` do not name."""
    said = " ".join(message.message for message in found)
    names = sorted(tools_for(configuration.target, configuration.communication))
    needed = find_tools(names, job.request.roots, plan.cache)
    lacking = missing_tools(needed, job.request.roots, plan.cache)
    return [message for title, message in lacking.items() if title not in said]


def _runs_here(job: Job) -> bool:
    """True if the products of ``job`` are programs for this computer."""
    configuration = configuration_of(job.request)
    return configuration is not None and configuration.target.platform.simulates_plant


def configuration_of(request: Request) -> Configuration | None:
    """The target's configuration; None if it has an error, which the build reports."""
    diagnostics = Diagnostics()
    return load_configuration(request, load_catalog(request.roots, diagnostics), diagnostics)
