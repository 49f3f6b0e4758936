# SPDX-License-Identifier: Apache-2.0
"""Files of a user's targets folder may contain anything: EPG reports errors, and never raises another exception."""

from __future__ import annotations

import copy
import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from epg.generator.catalog.catalog import FOLDERS, load_catalog
from epg.generator.check.configuration import check_configuration
from epg.generator.data import data_folder, targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.tcf import load_tcf_chain
from epg.generator.resolve.allocation import allocate
from epg.generator.resolve.claims import component_claims, tick_claims
from tests.catalog.everything import read_with

FILES = sorted(
    path
    for category, folder in FOLDERS.items()
    for path in (data_folder("targets") / folder).glob(f"*/{category}.yaml")
)
ODD = [None, True, 0, -1, 1.5, "", "x", "0-3", "3-0", "1-99999", "any", "slot", "A", [], ["x"], {}, {"x": 1}, 1 << 70]


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The paths of all values below ``value``."""
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield (*path, key)
        yield from places(child, (*path, key))


def changed(document: Any, chance: random.Random) -> Any:
    """A copy in which up to three values are deleted, replaced, or moved to another name."""
    document = copy.deepcopy(document)
    for _ in range(chance.randint(1, 3)):
        found = list(places(document))
        if not found:
            break
        *way, last = chance.choice(found)
        owner = document
        for step in way:
            owner = owner[step]
        act = chance.random()
        if act < 0.3:
            del owner[last]
        elif act < 0.5 and isinstance(owner, dict):
            owner[chance.choice(["x", "A", "0", "pins", "default"])] = owner.pop(last)
        else:
            owner[last] = copy.deepcopy(chance.choice(ODD))
    return document


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.parent.name}-{path.parent.name}")
def test_no_change_of_a_file_raises(path: Path, tmp_path: Path) -> None:
    """Random changes of values and structure, used for JIWY on a board and on the host."""
    chance = random.Random(path.parent.name)
    document = yaml.safe_load(path.read_text(encoding="utf-8"))
    copied = tmp_path / path.parent.parent.name / path.parent.name
    copied.mkdir(parents=True)
    for beside in path.parent.iterdir():
        if beside.is_file() and beside != path:
            (copied / beside.name).write_bytes(beside.read_bytes())
    reported = 0
    for _ in range(8):
        (copied / path.name).write_text(json.dumps(changed(document, chance)), encoding="utf-8")
        problems = Diagnostics()
        roots = targets_roots([tmp_path])
        catalog = load_catalog(roots, problems)
        read_with(catalog, path.stem)
        for name in ("rpi_pico2_freertos_jiwy", "host_jiwy"):
            chain = load_tcf_chain(name, roots, problems)
            configuration = check_configuration(chain, [], catalog, problems)
            if configuration is not None:
                control = configuration.control
                ticks = tick_claims(configuration.target, control.period, control.period_span)
                allocate([*component_claims(configuration), *ticks], configuration.target, problems)
        reported += problems.has_errors
    assert reported > 1  # the changes do have an effect
