# SPDX-License-Identifier: Apache-2.0
"""Any contents of the files of a user's ``targets`` folder: boards, chips, platforms and component kinds."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.fuzz.compiler import ROOT, compile_outputs, needs_compiler
from tests.fuzz.long_run import PROFILE, examples
from tests.fuzz.mutation import YAML_MUTATIONS, mutated
from tests.fuzz.project import Project, project_files
from tests.fuzz.test_files import WITH_PLANT, all_kinds

FOLDERS = (
    "boards/host",
    "socs/simulated",
    "platforms/host",
    "components/pwm",
    "components/quadrature_encoder",
    "components/ros_subscriber",
    "components/digital_input",
)


@cache
def with_targets() -> dict[str, bytes]:
    """A project with its own folder of targets, which holds everything that its target needs."""
    files = dict(all_kinds())
    for folder in FOLDERS:
        if (ROOT / "targets" / folder).is_dir():
            files |= project_files(ROOT / "targets" / folder, f"targets/{folder}")
    return files


def descriptions() -> list[str]:
    """The files that describe an item."""
    return sorted(name for name in with_targets() if name.startswith("targets/") and name.endswith(".yaml"))


def test_the_folder_is_used(tmp_path: Path) -> None:
    outcome = Project(tmp_path / "p", with_targets(), WITH_PLANT).generate(targets="targets")
    assert outcome.good, outcome.messages
    assert "[shadowed-item]" in outcome.messages
    assert len(descriptions()) == len(FOLDERS)


@needs_compiler
@settings(PROFILE, max_examples=examples(60))
@given(st.data())
def test_mutated_descriptions(tmp_path: Path, data: st.DataObject) -> None:
    files = with_targets()
    name = data.draw(st.sampled_from(descriptions()))
    changed = data.draw(mutated(files[name].decode(), YAML_MUTATIONS))
    outcome = Project(tmp_path / "p", files | {name: changed}, WITH_PLANT).generate(targets="targets")
    if outcome.good and data.draw(st.integers(0, 3)) == 0:
        compile_outputs("robot", outcome.files)


@settings(PROFILE, max_examples=examples(25))
@given(st.data(), st.binary(max_size=200))
def test_arbitrary_bytes_in_descriptions(tmp_path: Path, data: st.DataObject, junk: bytes) -> None:
    name = data.draw(st.sampled_from(descriptions()))
    Project(tmp_path / "p", with_targets() | {name: junk}, WITH_PLANT).generate(targets="targets")
