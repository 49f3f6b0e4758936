# SPDX-License-Identifier: Apache-2.0
"""Any contents of files and any edits: EPG makes an edit or refuses it, never crashes, and files stay consistent."""

from __future__ import annotations

import contextlib
import json
import random
from pathlib import Path
from typing import Any

import pytest

from epg.connect.body import Refused
from epg.connect.draft import SetEnds, SetValue
from epg.connect.editor import Editor
from epg.connect.files import Unsavable
from epg.connect.pictures import draw
from epg.connect.projects import Job, find_jobs
from epg.edit.bindings import CannotEdit, WireEnd
from epg.generator.diagnostics import Diagnostics

PIECES = """{ } [ ] : # ' - null ~ é inputs: unconnected 1e999 &a !!x extends: target:""".split(" ")
PIECES += ["\n", "\r\n", "\t", "\0", "components: 3\n", "extends: [a]\n", "extends: robot.tcf\n", "model: other\n"]
PORTS = ["position_pan", "setpoint_tilt", "pwm_pan", "pwm_tilt", "tilt_logging", "encoder_reset_pan", "no_port"]
REFERENCES = ["encoder_pan", "encoder_tilt.reset", "pwm_pan", "pan_publisher", "pan_subscriber", "nothing", "a.b.c"]


def job_of(project: Path) -> Job:
    (job,) = find_jobs(project, Diagnostics())
    return job


def any_end(chance: random.Random) -> WireEnd:
    limits = chance.choice([None, None, ("-1", "1"), ("2", "1"), ("a", "b")])
    return WireEnd(
        chance.choice(REFERENCES),
        scale=chance.choice(["", "", "1/4", "0", "-2.5", "x"]),
        offset=chance.choice(["", "", "0.5", "1e3"]),
        limits=limits,
        unit=chance.choice(["", "", "deg", "kg"]),
    )


def any_edit(editor: Editor, chance: random.Random) -> None:
    kind = chance.random()
    with contextlib.suppress(Refused, CannotEdit, Unsavable):
        if kind < 0.5:
            ends = tuple(any_end(chance) for _ in range(chance.choice([0, 1, 1, 1, 2])))
            editor.edit((SetEnds(chance.choice(PORTS), ends),))
        elif kind < 0.65:
            editor.edit((SetEnds(chance.choice(PORTS), None),))
        elif kind < 0.7:
            editor.edit((SetValue(("extends",), f"rpi_pico_bare_metal_{chance.choice(['jiwy', 'relbot'])}.tcf"),))
        elif kind < 0.85:
            editor.undo()
        else:
            editor.redo()


def shown(editor: Editor) -> dict[str, Any]:
    """The shown data, which must be JSON, with every offered picture."""
    state = editor.show()
    for name, offered in state["pictures"].items():
        assert (draw(editor.loaded, name, "robot") is not None) == offered
    editor.project()
    return dict(json.loads(json.dumps(state)))


@pytest.mark.parametrize("seed", range(4))
def test_saved_files_say_what_was_shown(seed: int, project: Path, bindings: Path) -> None:
    """Any edits, some undone and done again: a session that opens the saved files shows the same data."""
    chance = random.Random(seed)
    job = job_of(project)
    editor = Editor(job)
    for _ in range(3):
        for _ in range(8):
            any_edit(editor, chance)
        before = shown(editor)
        editor.save(anyway=False)
        after, anew = shown(editor), shown(Editor(job))
        for state in (before, after, anew):
            del state["draft"]
        assert before == after == anew
        assert not editor.draft.changed and not editor.look()
    while editor.draft.can_undo:
        editor.undo()
    editor.save(anyway=False)


@pytest.mark.parametrize("seed", range(4))
def test_damaged_files_are_shown(seed: int, project: Path, bindings: Path) -> None:
    chance = random.Random(seed)
    files = [bindings, project / "robot.tcf", *sorted((project / "model").glob("*.c"))]
    original = {path: path.read_bytes() for path in files}
    job = job_of(project)
    for _ in range(5):
        for path, data in original.items():
            path.write_bytes(damaged(data, chance) if chance.random() < 0.4 else data)
        editor = Editor(job)
        shown(editor)
        for _ in range(4):
            if chance.random() < 0.3:
                path = chance.choice(files)
                path.write_bytes(damaged(path.read_bytes(), chance))
                editor.look()
            any_edit(editor, chance)
            shown(editor)
        with contextlib.suppress(Refused, Unsavable):
            editor.save(anyway=chance.random() < 0.5)


def damaged(data: bytes, chance: random.Random) -> bytes:
    text = bytearray(data)
    for _ in range(chance.randint(1, 3)):
        place = chance.randrange(len(text) + 1)
        if chance.random() < 0.5:
            text[place:place] = chance.choice([*(piece.encode() for piece in PIECES), b"\xff"])
        else:
            del text[place : place + chance.randint(1, 12)]
    return bytes(text)
