# SPDX-License-Identifier: Apache-2.0
"""Real FMUs give the same bits in EPG's library as with their own functions.

They are not part of EPG: the environment variable EPG_TEST_EXPORTS names a folder with unpacked FMUs anywhere below it.
Their functions may have no prefix, because the importer sets it, or one that can be omitted.
"""

from __future__ import annotations

import os
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from epg.generator.importers import Model
from epg.generator.importers.fmu.fmu_files import is_fmu_folder
from tests.models.direct import run_fmu
from tests.models.fmus import pack, run_any
from tests.models.harness import build, load, loaded, run_wrapper

STEPS = 1000
SKIPPED = "set EPG_TEST_EXPORTS to a folder with real exports of 20-sim"
REFUSED = {
    "fmu-language",  # C++
    "fmu-file-missing",  # sources without a header, or no source in C
    "fmu-no-sources",
    "fmu-interface",
    "model-file-use",
    "model-heap",
    "fmu-variable",
    "fmu-guid",
    "model-stub",
    "fmu-not-compiled",
    "model-incomplete",
}


def fmu_paths() -> list[Path]:
    root = os.environ.get("EPG_TEST_EXPORTS")
    found = sorted(Path(root).rglob("modelDescription.xml")) if root else []
    return [path.parent for path in found if is_fmu_folder(path.parent) and (path.parent / "sources").is_dir()]


PATHS = fmu_paths()
needs_fmus = pytest.mark.skipif(not PATHS, reason=SKIPPED)


def readable(path: Path) -> str:
    return path.relative_to(os.environ["EPG_TEST_EXPORTS"]).as_posix() if PATHS else "none"


def usable(path: Path, folder: Path) -> Model | None:
    """The model, with a step of 10 ms if the FMU has none; None if EPG refuses it."""
    model, diagnostics = load(path)
    if model is None and any(item.id == "fmu-step" for item in diagnostics):
        folder.mkdir(exist_ok=True)
        text = f"version: 1\nfmu: {path}\nstep: 10 ms\ndefinitions: {{FMI_COSIMULATION: 1}}\n"  # the latter: FMU SDK
        (folder / "model.yaml").write_text(text)
        model, diagnostics = load(folder)
    if model is None:
        assert {item.id for item in diagnostics if item.severity == "error"} <= REFUSED
    return model


@needs_fmus
@pytest.mark.parametrize("path", PATHS or [Path("none")], ids=readable)
def test_same_numbers(path: Path, tmp_path: Path) -> None:
    """From the folder, and packed as an archive."""
    model = usable(path, tmp_path / "own")
    if model is None:
        return
    names = [port.name for port in model.inputs], [port.name for port in model.outputs]
    description = ElementTree.parse(path / "modelDescription.xml").getroot()
    of_20sim = description.attrib.get("generationTool", "").startswith("20-sim")
    if of_20sim:
        expected = run_fmu(path / "sources", tmp_path / "direct", *names, STEPS)
    else:
        expected = run_any(path, tmp_path / "direct", float(model.step), STEPS)
    assert run_wrapper(build(model, "model", tmp_path), STEPS, of_20sim) == expected
    if model.directory == path:
        packed = loaded(pack(path, tmp_path / "packed.fmu"))
        assert run_wrapper(build(packed, "packed", tmp_path), STEPS, of_20sim) == expected
