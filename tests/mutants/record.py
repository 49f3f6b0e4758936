# SPDX-License-Identifier: Apache-2.0
"""The record of mutants: for each language a file ``{file: [[before, after, state], ...]}``, and the age of the record.

The state is the test that noticed the mutant, ``none``, ``not tried`` if the computer lacks what the tests need,
``noticed earlier`` if a record without names of tests said so, or ``equivalent:`` and the reason why no user can notice
the mutant.
"""

from __future__ import annotations

import subprocess
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import yaml

from tests.checkout import ROOT

from .draw import SUFFIXES

HERE = Path(__file__).resolve().parent
RECORD = HERE / "record"
COMMAND = "python -m tests.mutants"
NONE = "none"
NOT_TRIED = "not tried"
EARLIER = "noticed earlier"
OLDEST = 500
"""The age in commits at which the record must be renewed."""


@dataclass(frozen=True)
class Mutant:
    file: str
    """Path from the root of the project, with slashes."""
    before: str
    after: str
    state: str = NOT_TRIED

    @property
    def test(self) -> str:
        """The test that noticed it, or empty."""
        return "" if self.kind != "noticed" or self.state == EARLIER else self.state

    @property
    def kind(self) -> str:
        """``noticed``, ``none``, ``not tried`` or ``equivalent``."""
        start = self.state.partition(":")[0]
        return start if start in (NONE, NOT_TRIED, "equivalent") else "noticed"

    def problem(self, root: Path = ROOT) -> str:
        """Says why the mutant does not apply, or is empty."""
        path = root / self.file
        if not path.is_file():
            return f"{self.file} is gone (of a file that was moved, change the path in {RECORD.relative_to(ROOT)})"
        places = path.read_text(encoding="utf-8").count(self.before)
        return "" if places == 1 else f"{self.file}: {places} places have this text: {self.before}"


def rooms() -> dict[str, list[str]]:
    """The tests of each room, which is a folder and a suffix: ``epg/connect/*.js``."""
    tables = [HERE / "rooms.yaml", *sorted(ROOT.glob("integration/*/tests/mutants.yaml"))]
    found = (yaml.safe_load(table.read_text(encoding="utf-8")) for table in tables)
    return {room: tests.split() for table in found for room, tests in table.items()}


def room_of(file: str, names: Iterable[str]) -> str | None:
    """The room of a file: of all folders that contain it, the innermost one in the table.  A header belongs to C."""
    suffix = "*.c" if file.endswith(".h") else f"*{Path(file).suffix}"
    found = [room for room in names if room.endswith(f"/{suffix}") and f"/{file}".startswith(_folder(room))]
    return max(found, key=len, default=None)


def _folder(room: str) -> str:
    return f"/{room.rpartition('/')[0]}/".replace("//", "/")


def read(folder: Path = RECORD) -> list[Mutant]:
    found = []
    for language in sorted(set(SUFFIXES.values())):
        path = folder / f"{language}.yaml"
        listed = yaml.safe_load(path.read_text(encoding="utf-8")) if path.is_file() else {}
        found += [Mutant(file, *entry) for file, entries in listed.items() for entry in entries]
    return found


def write(mutants: Iterable[Mutant], folder: Path = RECORD) -> None:
    files: dict[str, dict[str, list[list[str]]]] = {language: {} for language in SUFFIXES.values()}
    for one in sorted(mutants, key=lambda one: (one.file, one.before, one.after)):
        language = SUFFIXES[Path(one.file).suffix]
        files[language].setdefault(one.file, []).append([one.before, one.after, one.state])
    for language, found in files.items():
        text = yaml.safe_dump(found, default_flow_style=None, allow_unicode=True, width=10_000)
        (folder / f"{language}.yaml").write_text(f"# Written by {COMMAND}.\n{text}", encoding="utf-8")


def commits(root: Path = ROOT) -> int | None:
    """The number of commits of the project's history, or None where it has no history, or only a part of it."""
    git = ["git", "-C", str(root)]
    try:
        whole = subprocess.run(
            [*git, "rev-parse", "--is-shallow-repository", "--show-prefix"], capture_output=True, text=True
        )
        count = subprocess.run([*git, "rev-list", "--count", "HEAD"], capture_output=True, text=True)
    except OSError:
        return None
    return int(count.stdout) if whole.stdout.split() == ["false"] and count.returncode == 0 else None


def age() -> int | None:
    """The number of commits since the record was renewed, or None where there is no whole history."""
    renewed = int((RECORD / "renewed_at_commit.txt").read_text(encoding="utf-8"))
    now = commits()
    return None if now is None else max(0, now - renewed)


def renewed() -> None:
    """Notes that the record is of the present commit."""
    (RECORD / "renewed_at_commit.txt").write_text(f"{commits() or 0}\n", encoding="utf-8")


def problems(mutants: Iterable[Mutant], old: int | None) -> Iterator[str]:
    """What is wrong with a record that is ``old`` commits old: one message for each mutant and for the age."""
    for one in mutants:
        if found := one.problem():
            yield found
    if old is not None and old > OLDEST:
        yield f"the record is {old} commits old, and must be renewed after {OLDEST}"


def summary(mutants: Iterable[Mutant], old: int | None) -> str:
    """One line for continuous integration."""
    kinds = Counter(one.kind for one in mutants)
    shown = f"{kinds['noticed']} noticed, {kinds[NONE]} not noticed, {kinds[NOT_TRIED]} not tried"
    shown_age = "unknown" if old is None else f"{old} commits"
    return f"record of mutants: {shown}, {kinds['equivalent']} equivalent; age: {shown_age}"
