# SPDX-License-Identifier: Apache-2.0
"""Mutants of small sources, the record and its age, and the search for the test that notices a mutant."""

from __future__ import annotations

import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest

from tests.checkout import ROOT
from tests.mutants import record, trial
from tests.mutants.__main__ import _moved, draw, main, sources
from tests.mutants.draw import compiles, mutants
from tests.mutants.record import EARLIER, NONE, NOT_TRIED, Mutant

PYTHON = '''
class Pins:
    def free(self, pin: int) -> bool:
        """Whether pin < 1 is free."""
        # pin < 2
        if pin >= self.first and not self.used:
            self.log(f"pin < {pin}")
            return self.count - 1
        for pin in self.pins:
            raise KeyError(pin)
'''
C = """
#define FIRST (1 < 2)
int sum(const int *values, size_t count)
{
    /* i < 3 */
    for (size_t i = 0U; i < count; i++) {
        result += values[i];
    }
    if (result) {
        show("a < b");
    }
    return -result;
}
"""


@pytest.mark.parametrize(
    ("suffix", "source", "wanted"),
    [
        (
            ".py",
            PYTHON,
            [
                "if not (pin >= self.first and not self.used):",
                "if pin > self.first and not self.used:",
                "if pin >= self.first or not self.used:",
                "if pin >= self.first and self.used:",
                "pass",
                "return None",
                "return self.count + 1",
                "return self.count - 2",
                "pass",
            ],
        ),
        (
            ".c",
            C,
            [
                "for (size_t i = 1U; i < count; i++) {",
                "for (size_t i = 0U; i <= count; i++) {",
                ";",
                "result -= values[i];",
                "if (!(result)) {",
                ";",
            ],
        ),
        (
            ".js",
            "show(`a < ${b}`);\nif (a === b) {\n  return false;\n}\n",
            [";", "if (!(a === b)) {", "if (a !== b) {", "return true;"],
        ),
        (
            ".j2",
            "{# a < b #}\n{% if a and 'b < c' %}\nstart(1 < {{ a + 2 }});\n{% endif %}\n",
            ["{% if not (a and 'b < c') %}", ";", "start(1 < {{ a - 2 }});", "start(1 < {{ a + 3 }});"],
        ),
    ],
    ids=["python", "c", "javascript", "template"],
)
def test_mutants_of_each_language(suffix: str, source: str, wanted: list[str]) -> None:
    found = list(mutants(source, suffix))
    assert [after for _, after in found] == wanted
    assert all(source.count(before) == 1 and compiles(source.replace(before, after), suffix) for before, after in found)


def test_a_line_that_occurs_twice_is_not_changed() -> None:
    assert list(mutants("a = bcd < e\n", ".py"))
    assert not list(mutants("a = bcd < e\n" * 2, ".py"))


def test_the_record_is_read_as_it_was_written(tmp_path: Path) -> None:
    found = [
        Mutant("a.c", "x = 1;", ";", "tests/test_a.py::test_b[c, d: 'e']"),
        Mutant("a.c", "y = 1;\n    z = 2;", ";", "equivalent: nobody reads it"),
        Mutant("b.h", "w = 1;", ";", NONE),
        Mutant("c.py", "return a[b, c]", "return None", EARLIER),
        Mutant("d.js", 'a("b");', ";", NOT_TRIED),
    ]
    record.write(found, tmp_path)
    assert sorted(record.read(tmp_path), key=lambda one: one.file) == found
    assert [one.kind for one in found] == ["noticed", "equivalent", NONE, "noticed", NOT_TRIED]
    assert [one.test for one in found if one.test] == ["tests/test_a.py::test_b[c, d: 'e']"]
    shown = "2 noticed, 1 not noticed, 1 not tried, 1 equivalent; age: 7 commits"
    assert record.summary(found, 7) == f"record of mutants: {shown}"


def test_problems_of_a_record(tmp_path: Path) -> None:
    (tmp_path / "a.c").write_text("x = 1;\nx = 1;\ny = 1;\n")
    assert Mutant("a.c", "y = 1;", ";").problem(tmp_path) == ""
    assert Mutant("a.c", "x = 1;", ";").problem(tmp_path) == "a.c: 2 places have this text: x = 1;"
    assert Mutant("a.c", "z = 1;", ";").problem(tmp_path) == "a.c: 0 places have this text: z = 1;"
    assert Mutant("b.c", "y = 1;", ";").problem(tmp_path).startswith("b.c is gone (of a file that was moved, change")
    assert list(record.problems([], record.OLDEST)) == []
    assert list(record.problems([], record.OLDEST + 1)) == [
        "the record is 501 commits old, and must be renewed after 500"
    ]


def test_only_the_whole_history_of_the_project_has_an_age(tmp_path: Path) -> None:
    if shutil.which("git") is None:
        pytest.skip("git is not installed: sudo apt install git")
    assert record.commits(tmp_path) is None
    command = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a"]
    for words in ["init", "--quiet"], *(["commit", "--quiet", "--allow-empty", "--message=a"],) * 3:
        subprocess.run([*command, *words], check=True)
    (tmp_path / "inside").mkdir()
    assert record.commits(tmp_path) == 3
    assert record.commits(tmp_path / "inside") is None
    shallow = tmp_path / "shallow"
    subprocess.run([*command, "clone", "--quiet", "--depth=1", f"file://{tmp_path}", str(shallow)], check=True)
    assert record.commits(shallow) is None


def test_the_record_applies_and_is_not_too_old() -> None:
    found = "\n".join(record.problems(record.read(), record.age()))
    message = "If you changed a statement, change the text of its mutant, too, or draw others"
    assert not found, f"{found}\n{message}: {record.COMMAND} --mend.  A record that is too old: {record.COMMAND}"


def test_a_mutant_of_a_file_that_moved_is_found() -> None:
    file = "tests/mutants/trial.py"
    moved = Mutant(f"elsewhere/{Path(file).name}", "self._sound: set[str] = set()", "pass")
    assert _moved(moved) == Mutant(file, moved.before, moved.after)
    assert _moved(Mutant("elsewhere/trial.py", "there is no such text", "pass")) is None


def test_each_source_has_a_room_with_tests() -> None:
    rooms = record.rooms()
    found = Counter(record.room_of(file, rooms) for file in sources())
    assert found[None] == 0, [file for file in sources() if record.room_of(file, rooms) is None]
    assert [room for room in rooms if not found[room]] == [], "rooms without sources"
    missing = {test for tests in rooms.values() for test in tests if not (ROOT / test.partition("::")[0]).exists()}
    assert missing == set()
    assert all(rooms.values())


def test_each_room_has_mutants() -> None:
    rooms = record.rooms()
    found = {record.room_of(one.file, rooms) for one in record.read()}
    lacking = {room: tests for room, tests in rooms.items() if room not in found}
    assert [one.file for one in draw([], lacking, 1, 1)] == [], f"draw mutants for them: {record.COMMAND} --mend"


def test_a_test_that_passes_without_a_mutant_notices_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "listed", lambda *arguments: [])
    copy = trial.Copy(tmp_path)
    tree = tmp_path / "epg"
    tree.mkdir()
    (tree / "a.py").write_text("def f(a):\n    return a < 1\n\ndef g(a):\n    return a < 1 + 0\n")
    head = "import pytest, a\npytestmark = pytest.mark.check\n"
    (tree / "test_a.py").write_text(f"{head}def test_wrong(): assert a.f(9)\ndef test_f(): assert not a.f(1)\n")
    (tree / "test_b.py").write_text(f"{head}def test_b(): pytest.skip('there is no SDK')\n")
    (tree / "pytest.ini").write_text("[pytest]\nmarkers = check\n")
    noticed = Mutant("a.py", "return a < 1\n", "return a <= 1\n")
    assert copy.state_of(noticed, ["test_a.py"]) == "test_a.py::test_f"
    assert copy.state_of(Mutant("a.py", "a < 1 + 0", "a <= 1 + 0"), ["test_a.py"]) == NONE
    assert copy.state_of(noticed, ["test_b.py"]) == NOT_TRIED
    again = Mutant(noticed.file, noticed.before, noticed.after, "test_a.py::test_that_is_gone")
    assert copy.state_of(again, ["test_a.py"]) == "test_a.py::test_f"
    assert (tree / "a.py").read_text().startswith("def f(a):\n    return a < 1\n")


def test_mutants_that_were_caught_are_still_caught() -> None:
    assert main(["--check"]) == 0
