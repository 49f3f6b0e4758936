# SPDX-License-Identifier: Apache-2.0
"""The output folder, with any contents that an earlier run, another program or a user left in it."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.project import OUTPUT, Project
from tests.fuzz.test_files import WITH_PLANT, all_kinds


@pytest.mark.parametrize(
    "manifest",
    [
        b"",
        b"{",
        b"[" * 100_000,
        b"null",
        b"[1, null]",
        b'["../robot.tcf", "/etc/hostname", "a\\u0000b", ""]',
        b"\xff",
        b'"robot.h"',
    ],
    ids=lambda value: repr(value[:12]),
)
def test_a_damaged_list_of_outputs(manifest: bytes, tmp_path: Path) -> None:
    """EPG makes the list again, and deletes nothing outside the folder."""
    files = all_kinds() | {f"{OUTPUT}/.epg-outputs.json": manifest}
    outcome = Project(tmp_path / "p", files, WITH_PLANT).generate()
    assert outcome.good
    assert "robot.h" in outcome.files


def test_files_that_are_no_longer_made_are_deleted(tmp_path: Path) -> None:
    project = Project(tmp_path / "p", all_kinds(), WITH_PLANT)
    first = project.generate()
    assert "robot_plant.c" in first.files
    project.command = [word for word in project.command if "plant" not in word]
    second = project.generate()
    assert second.good and "robot_plant.c" not in second.files


def test_a_run_that_fails_changes_nothing(tmp_path: Path) -> None:
    project = Project(tmp_path / "p", all_kinds(), WITH_PLANT)
    assert project.generate().good
    (project.folder / "bindings.yaml").write_bytes(b"version: 1\n")
    assert not project.generate().good  # generate() also asserts that the folder is unchanged


def test_a_file_in_the_place_of_the_folder(tmp_path: Path) -> None:
    from tests.fuzz.project import run_epg

    project = Project(tmp_path / "p", all_kinds() | {OUTPUT: b"a file"}, WITH_PLANT)
    status, _, messages = run_epg([*project.command, "--output", OUTPUT], project.folder, 10)
    assert status == 4 and "Traceback" not in messages
    assert (project.folder / OUTPUT).read_bytes() == b"a file"
