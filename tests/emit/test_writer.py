# SPDX-License-Identifier: Apache-2.0
"""The writer changes only files whose contents differ, writes whole files, and stays in its folder."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from epg.cli.output import update_folder
from epg.generator.emit.folder import write_folder
from epg.generator.emit.writer import write_outputs

ROOT = Path(__file__).resolve().parents[2]


def test_only_what_changed_is_written(tmp_path: Path) -> None:
    assert write_outputs(tmp_path, {"a.c": "1\n", "sub/b.c": "2\n"}) == ["a.c", "sub/b.c"]
    os.utime(tmp_path / "a.c", ns=(1, 1))
    assert write_outputs(tmp_path, {"a.c": "1\n", "sub/b.c": "3\n"}) == ["sub/b.c"]
    assert (tmp_path / "a.c").stat().st_mtime_ns == 1
    assert (tmp_path / "sub/b.c").read_text() == "3\n"


def test_no_line_end_is_translated(tmp_path: Path) -> None:
    write_outputs(tmp_path, {"a": "x\r\ny\n"})
    assert (tmp_path / "a").read_bytes() == b"x\r\ny\n"


@pytest.mark.parametrize("name", ["../a", "/tmp/a", "sub/../../a"])
def test_nothing_is_written_outside(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="outside"):
        write_outputs(tmp_path / "out", {name: "x"})


def test_a_failure_leaves_the_old_file_and_no_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_outputs(tmp_path, {"a": "old"})

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="disk full"):
        write_outputs(tmp_path, {"a": "new"})
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    assert (tmp_path / "a").read_text() == "old"


def test_the_next_run_removes_what_a_killed_one_has_left(tmp_path: Path) -> None:
    killed = (
        "import os, signal\nfrom pathlib import Path\nfrom epg.generator.emit.writer import write_outputs\n"
        "os.replace = lambda *_: os.kill(os.getpid(), signal.SIGKILL)\n"
        f"write_outputs(Path({str(tmp_path)!r}), {{'a': '1'}})\n"
    )
    result = subprocess.run([sys.executable, "-c", killed], env=os.environ | {"PYTHONPATH": str(ROOT)})
    assert result.returncode == -signal.SIGKILL and len(os.listdir(tmp_path)) == 1
    write_outputs(tmp_path, {"a": "1"})
    assert os.listdir(tmp_path) == ["a"]


def test_what_is_no_longer_generated_is_deleted_and_nothing_else(tmp_path: Path) -> None:
    update_folder(tmp_path, {"a": "1", "b": "2"}, None)
    (tmp_path / "mine").write_text("of the user")
    update_folder(tmp_path, {"a": "1"}, None)
    assert sorted(path.name for path in tmp_path.iterdir()) == [".epg-outputs.json", "a", "mine"]


def test_a_link_that_leads_out_of_the_folder_is_no_bug_of_epg(tmp_path: Path) -> None:
    (tmp_path / "out").mkdir()
    (tmp_path / "out/a").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(PermissionError, match="a link leads out of the output folder"):
        write_outputs(tmp_path / "out", {"a": "1"})
    assert not (tmp_path / "elsewhere").exists()


def test_a_file_in_the_way_leaves_the_folder_as_it_was(tmp_path: Path) -> None:
    """An empty folder of the user stays, too."""
    (tmp_path / "robot/source").mkdir(parents=True)
    (tmp_path / "robot/z.txt").write_text("mine")
    with pytest.raises(FileExistsError):
        write_folder(tmp_path / "robot", {"source/new/a.c": b"", "z.txt": b""})
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["robot", "source", "z.txt"]
    assert (tmp_path / "robot/z.txt").read_text() == "mine"
