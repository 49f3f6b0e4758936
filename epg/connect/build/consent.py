# SPDX-License-Identifier: Apache-2.0
"""Asks the user for consent before the first build in a folder, and shows the commands that it would run.

A project from another person may name any program: in its CMake files, or in the cache of a build folder.  The user
must therefore agree to the commands once, and again when the programs or the folders change.  EPG's cache keeps the
answers.

>>> # question = question_about(job)
>>> # question.commands  ->  ("cmake -S /robot -B /robot/build -G Ninja", "cmake --build /robot/build")
>>> # question.agree()
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from epg.connect.build.plan import make_plan
from epg.connect.projects import Job
from epg.generator.bootstrap import cache_folder
from epg.generator.check.configuration import Configuration
from epg.generator.dataclass import dataclass
from epg.generator.system import here

FILE = "agreed-builds"
"""A file in EPG's cache, with one line for each :attr:`Question.key` that the user has agreed to."""
KEPT = 1000


@dataclass(frozen=True)
class Question:
    """The ``commands`` as a user would type them in ``folder``, and the ``programs`` that they run.

    ``key`` is a hash of the folders of source and build, and of the programs.
    """

    folder: Path
    commands: tuple[str, ...]
    programs: tuple[str, ...]
    key: str

    def data(self) -> dict[str, Any]:
        return {**asdict(self), "folder": str(self.folder)}

    def agree(self) -> None:
        """Notes the user's consent.  If EPG's cache cannot be written, the consent holds until EPG ends."""
        _agreed.add(self.key)
        file = cache_folder() / FILE
        with suppress(OSError):
            file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            file.write_text("".join(f"{key}\n" for key in [*_lines(file), self.key][-KEPT:]), encoding="ascii")


def question_about(
    job: Job,
    configuration: Configuration | None,
    after: Sequence[tuple[str, ...]] = (),
    *,
    anyway: bool = False,
) -> Question | None:
    """The question to ask before ``job`` is built; ``anyway`` as for :func:`make_plan`.

    ``after`` are commands that run after the build, and that start what it has made.

    None if there is nothing to run, or the user has agreed before.  This runs no program that a build folder names.
    """
    plan = make_plan(job, configuration, run=False, anyway=anyway)
    if not plan.steps:
        return None
    programs = {step.command[0] for step in plan.steps} | {plan.build_program}
    programs |= {command[0] for command in after}
    names = sorted({os.path.normcase(program) for program in programs})  # CMake's cache has "/" on Windows
    folders = (os.path.realpath(plan.source), os.path.realpath(plan.build))
    key = json.dumps([*folders, names, _number(plan.source), *after])
    question = Question(
        plan.steps[0].folder,
        tuple(_shown(command) for command in (*(step.command for step in plan.steps), *after)),
        tuple(sorted(programs)),
        _hash(key),
    )
    return _unless_agreed(question)


def question_about_program(command: tuple[str, ...], folder: Path) -> Question | None:
    """The question to ask before a program of a build runs in ``folder``; None if the user has agreed before."""
    key = json.dumps([os.path.realpath(command[0]), *command[1:], _number(folder)])
    return _unless_agreed(Question(folder, (_shown(command),), (command[0],), _hash(key)))


_agreed: set[str] = set()


def _unless_agreed(question: Question) -> Question | None:
    known = question.key in _agreed or question.key in _lines(cache_folder() / FILE)
    return None if known else question


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def _number(folder: Path) -> int:
    """The inode number: a new folder with the same path has another one, and needs a new consent."""
    try:
        return folder.stat().st_ino
    except OSError:
        return 0


def _lines(file: Path) -> list[str]:
    try:
        return file.read_text(encoding="ascii").split()
    except (OSError, ValueError):
        return []


def _shown(command: tuple[str, ...]) -> str:
    return here.quoted(command)
