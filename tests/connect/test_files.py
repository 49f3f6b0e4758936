# SPDX-License-Identifier: Apache-2.0
"""Files of a session: saved at once and completely, otherwise unchanged; edits by other programs are detected."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from epg.connect.files import BOM, Snapshot, Unsavable, Watch, read_snapshot, save
from epg.generator.emit.leftovers import remove_leftovers
from tests.connect.page import Denied, Page, serving, session_of

ROOT = Path(__file__).resolve().parent.parent.parent
WRITER = """
import sys
from pathlib import Path
from epg.connect.files import Snapshot, read_snapshot, save
path = Path(sys.argv[1])
print("ready", flush=True)
while True:
    before = read_snapshot(path)
    letter = b"b" if before.data.startswith(b"a") else b"a"
    save(before, Snapshot(path, letter * 200_000 + b"\\n"))
"""


def test_a_file_is_never_half_written(tmp_path: Path) -> None:
    """A process that saves without a pause is killed many times while others read: readers see only whole files."""
    path = tmp_path / "robot.bindings.yaml"
    whole = {b"a" * 200_000 + b"\n", b"b" * 200_000 + b"\n"}
    path.write_bytes(b"a" * 200_000 + b"\n")
    chance = random.Random(7)
    seen = set()
    for _ in range(25):
        command = [sys.executable, "-c", WRITER, str(path)]
        writer = subprocess.Popen(command, stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": str(ROOT)})
        assert writer.stdout is not None and writer.stdout.readline().strip() == b"ready"
        for _ in range(chance.randrange(200)):
            seen.add(path.read_bytes())
        writer.kill()
        writer.wait()
        writer.stdout.close()
        seen.add(path.read_bytes())
        remove_leftovers(path)
        assert os.listdir(tmp_path) == [path.name]
    assert seen == whole


def test_what_a_killed_session_leaves_goes_at_the_next_start(project: Path, bindings: Path, tmp_path: Path) -> None:
    import fcntl

    names = [f".{bindings.name}.0123456789ab", ".robot.tcf.ba9876543210"]
    others = [f".{bindings.name}.swp", f".{bindings.name}.0123456789abc", f"{bindings.name}.0123456789ab"]
    for name in (*names, *others):
        (project / name).write_text("half of")
    held = project / f".{bindings.name}.00000000000a"
    outside = tmp_path / "outside"
    outside.write_text("mine")
    link = project / f".{bindings.name}.00000000000b"
    link.symlink_to(outside)
    with held.open("wb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with serving(session_of(project)):
            left = {path.name for path in project.iterdir()}
    assert not left & set(names) and {*others, held.name, link.name} <= left, "what is being written stays"
    assert outside.read_text() == "mine"


def test_line_ends_and_mark_stay(page: Page, bindings: Path) -> None:
    text = bindings.read_bytes().replace(b"\n", b"\r\n")
    bindings.write_bytes(BOM + text)
    page.until(lambda state: state["draft"]["external"])
    assert page.state()["diagnostics"] == []
    state = page.connect("setpoint_pan", "tilt_subscriber")
    assert "\r" not in state["draft"]["diff"]
    page.post("save")
    before = b"setpoint_pan: {from: pan_subscriber, follows: position_pan}"
    assert before in text
    expected = text.replace(before, b"setpoint_pan: tilt_subscriber")
    assert bindings.read_bytes() == BOM + expected


def test_permissions_stay(page: Page, bindings: Path) -> None:
    bindings.chmod(0o640)
    page.connect("setpoint_pan", "tilt_subscriber")
    page.post("save")
    assert bindings.stat().st_mode & 0o777 == 0o640
    assert sorted(path.name for path in bindings.parent.glob(".robot*")) == []


def test_a_link_stays_a_link(project: Path, bindings: Path) -> None:
    real = project / "shared" / "real.yaml"
    real.parent.mkdir()
    bindings.rename(real)
    bindings.symlink_to(real)
    with serving(session_of(project)) as page:
        page.connect("setpoint_pan", "tilt_subscriber")
        page.post("save")
        assert bindings.is_symlink() and "setpoint_pan: tilt_subscriber" in real.read_text()
        real.write_text(real.read_text() + "# through the link\n")
        assert page.until(lambda state: state["draft"]["external"])


def test_a_link_out_of_the_project_is_not_followed(project: Path, bindings: Path, tmp_path: Path) -> None:
    real = tmp_path / "a robot.shared" / "real.yaml"
    real.parent.mkdir()
    bindings.rename(real)
    bindings.symlink_to(real)
    before = real.read_text()
    with serving(session_of(project)) as page:
        page.connect("setpoint_pan", "tilt_subscriber")
        for anyway in (False, True):
            with pytest.raises(Denied, match="outside of") as refusal:
                page.post("save", anyway=anyway)
            assert str(real) in refusal.value.message and refusal.value.status == 409
        assert page.state()["draft"]["changed"]
    assert bindings.is_symlink() and real.read_text() == before and os.listdir(real.parent) == [real.name]


def test_links_above_the_project_are_none_of_its_own(project: Path, tmp_path: Path) -> None:
    """A project that is reached through a link, and a folder in it that is a link to another place."""
    (tmp_path / "link").symlink_to(project)
    with serving(session_of(tmp_path / "link")) as page:
        page.connect("setpoint_pan", "tilt_subscriber")
        page.post("save")
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "a.yaml").write_text("one\n")
    (project / "sub").symlink_to(outside)
    path = project / "sub" / "a.yaml"
    before = read_snapshot(path)
    with pytest.raises(Unsavable, match="outside of"):
        save(before, before.with_text("two\n"), project=project)
    assert (outside / "a.yaml").read_text() == "one\n"
    named = read_snapshot(outside / "a.yaml")
    save(named, named.with_text("two\n"), project=project)  # a file that the user has named may be elsewhere
    assert (outside / "a.yaml").read_text() == "two\n"


def test_a_new_file_has_usual_permissions(tmp_path: Path) -> None:
    path = tmp_path / "sub" / "new.yaml"
    usual = tmp_path / "usual"
    usual.write_text("")
    save(read_snapshot(path), Snapshot(path, b"text\n"))
    assert path.read_bytes() == b"text\n" and path.stat().st_mode == usual.stat().st_mode


def test_nothing_is_saved_over_anothers_edit(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("one\n")
    before = read_snapshot(path)
    path.write_text("two\n")
    with pytest.raises(Unsavable, match=r"another program changed 'a.yaml'"):
        save(before, before.with_text("three\n"))
    assert path.read_text() == "two\n"
    save(before, before.with_text("three\n"), anyway=True)
    assert path.read_text() == "three\n"


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    path = tmp_path / "file" / "a.yaml"
    with pytest.raises(Unsavable, match=r"cannot write 'a.yaml'"):
        save(Snapshot(path, None), Snapshot(path, b"text\n"))


PROTECTED = """
import os, sys
from pathlib import Path
from epg.connect.files import Snapshot, Unsavable, read_snapshot, save
path = Path(sys.argv[1])
if hasattr(os, "geteuid") and os.geteuid() == 0:
    os.setgid(65534)  # root may write everything
    os.setuid(65534)
try:
    save(read_snapshot(path), Snapshot(path, b"two\\n"))
except Unsavable as problem:
    print(problem)
"""


def test_a_protected_file_stays() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o777)
        path = folder / "a.yaml"
        path.write_text("one\n")
        path.chmod(0o444)
        command = [sys.executable, "-c", PROTECTED, str(path)]
        said = subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PYTHONPATH": str(ROOT)})
        assert said.stdout == "'a.yaml' is write-protected\n", said.stderr
        assert path.read_text() == "one\n" and os.listdir(folder) == ["a.yaml"]


def test_edits_are_noticed_by_content(tmp_path: Path) -> None:
    path, missing = tmp_path / "a.yaml", tmp_path / "later.yaml"
    path.write_text("one\n")
    watch = Watch((path, missing, tmp_path))
    assert watch.changed() == []
    os.utime(path, ns=(1, 1))
    assert watch.changed() == [], "a file that was only touched has the same text"
    path.write_text("two\n")
    assert watch.changed() == [path]
    assert watch.changed() == []
    missing.write_text("")
    assert watch.changed() == [tmp_path, missing]
    missing.write_text("text\n")
    assert watch.changed() == [missing]
    path.unlink()
    assert watch.changed() == [tmp_path, path]


def test_what_was_read_counts_not_what_is_there(tmp_path: Path) -> None:
    path = tmp_path / "a.yaml"
    path.write_text("one\n")
    snapshot = read_snapshot(path)
    path.write_text("two\n")
    assert Watch((path,), (snapshot,)).changed() == [path]
    assert Watch((path,), (read_snapshot(path),)).changed() == []


def test_a_session_that_is_killed_leaves_files_whole(project: Path, bindings: Path) -> None:
    """The whole program is killed while a page saves repeatedly."""
    texts = {bindings.read_text()}
    for number in range(3):
        command = [sys.executable, str(ROOT / "epg"), "connect", str(project), "--no-browser"]
        program = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert program.stdout is not None
        page = Page(program.stdout.readline().split()[-1])
        for scale in (number + 2, number + 12):
            page.connect("pan_logging", "pan_publisher", scale=scale)
            diff = page.post("save")["draft"]["diff"]
            assert diff == ""
            texts.add(bindings.read_text())
        page.connect("pan_logging", "pan_publisher", scale=99)
        program.kill()
        program.wait()
        program.stdout.close()
        assert bindings.read_text() in texts and "scale: 99" not in bindings.read_text()
    assert len(texts) == 7
