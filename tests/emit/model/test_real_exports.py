# SPDX-License-Identifier: Apache-2.0
"""Real exports give the same bits in EPG's library as with their own code.

They are not part of EPG: the environment variable EPG_TEST_EXPORTS names a folder whose subfolders are repositories
with exports of 20-sim, in any layout.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from epg.generator.importers import Model
from tests.models.direct import has_entry_points, run_c_vectors, run_cpp_class, run_fmu
from tests.models.harness import build, load, loaded, run_wrapper
from tests.twenty_sim.direct import close, compile_export, difference
from tests.twenty_sim.generate import generate_from

STEPS = 1500
SKIPPED = "set EPG_TEST_EXPORTS to a folder with real exports of 20-sim"


def model_paths() -> list[Path]:
    """Every submodel below the folder: files with the functions of a C submodel, and files of C++ classes."""
    root = os.environ.get("EPG_TEST_EXPORTS")
    if not root:
        return []
    found: set[Path] = set()
    found |= {path for path in Path(root).rglob("*.c") if path.is_file() and has_entry_points(path)}
    found = {path for path in found if not _lacks_description(path.parent)}
    for path in Path(root).rglob("*.cpp"):
        if path.is_file() and "::CopyInputsToVariables" in path.read_text("latin-1"):
            found.add(path)
    return sorted(found)


def _lacks_description(sources: Path) -> bool:
    """True for the sources of an FMU without its description, which is needed to call its functions."""
    return (sources / "fmi2Functions.c").is_file() and not (sources.parent / "modelDescription.xml").is_file()


def readable(path: Path) -> str:
    if not PATHS:
        return "none"
    return path.relative_to(os.environ["EPG_TEST_EXPORTS"]).as_posix()


PATHS = model_paths()
needs_exports = pytest.mark.skipif(not PATHS, reason=SKIPPED)


def direct(model: Model, path: Path, work: Path) -> tuple[str, bool]:
    """The results of the export's own code, and True if it starts with inputs of zero."""
    counts = (len(model.inputs), len(model.outputs))
    details = model.code
    if model.language == "c++":
        units = [code.file.path for code in details.linked.units]  # type: ignore[attr-defined]
        places = list(details.linked.include_dirs)  # type: ignore[attr-defined]
        name = details.class_name  # type: ignore[attr-defined]
        return run_cpp_class(model.directory, name, work, counts, STEPS, units, places), False
    names = [port.name for port in model.inputs], [port.name for port in model.outputs]
    if (model.directory / "fmi2Functions.c").is_file():
        return run_fmu(model.directory, work, *names, STEPS), True
    linked = details.linked  # type: ignore[attr-defined]
    function, _, suffix = details.calculate.name.partition("CalculateSubmodel")  # type: ignore[attr-defined]
    variable = details.states.partition("s")[0] if details.states else "xx_"  # type: ignore[attr-defined]
    argument = repr(float(model.step)) if "step" in details.calculate.arguments else ""  # type: ignore[attr-defined]
    includes = list(linked.include_dirs)
    for shim in linked.shims:  # the export lacks this header: give the direct program an empty one
        (work / "lacking").mkdir(parents=True, exist_ok=True)
        (work / "lacking" / shim.name).write_text("")
        includes.append(work / "lacking")
    sources = [code.file.path for code in linked.units]
    return run_c_vectors(sources, includes, work, counts, STEPS, suffix, (variable, function), argument), False


@needs_exports
@pytest.mark.parametrize("path", PATHS or [Path("none")], ids=readable)
def test_same_numbers(path: Path, tmp_path: Path) -> None:
    model, diagnostics = load(path)
    if model is None:
        # an export that developers have edited in part, that reads files, or that shares its folder with other models
        assert {i.id for i in diagnostics if i.severity == "error"} <= {
            "model-file-missing",
            "model-incomplete",
            "model-undeclared",
            "model-ports",
            "model-ambiguous",
            "model-dll",
            "model-heap",
            "model-file-use",
            "model-stub",
        }
        return
    expected, zero_start = direct(model, path, tmp_path)
    assert run_wrapper(build(model, "model", tmp_path), STEPS, zero_start) == expected
    assert len(expected.splitlines()) == STEPS + 2


@needs_exports
@pytest.mark.parametrize("path", PATHS or [Path("none")], ids=readable)
def test_tokens_alone(path: Path, tmp_path: Path) -> None:
    folder = path.parent
    files = sorted(folder.glob("*tokens.xml"))
    model, _ = load(path)
    if model is None or not files:
        return
    from_tokens, diagnostics = load(files[0])
    if from_tokens is None and any("matrices" in item.message for item in diagnostics):
        return
    assert from_tokens is not None, [item.message for item in diagnostics]
    if from_tokens.name != model.name or from_tokens.version != model.version:
        return
    assert [(p.name, p.value) for p in from_tokens.parameters] == [(p.name, p.value) for p in model.parameters]
    expected = run_wrapper(build(model, "sources", tmp_path), STEPS, True)
    assert run_wrapper(build(from_tokens, "tokens", tmp_path), STEPS, True) == expected


TOKENS = sorted(Path(os.environ["EPG_TEST_EXPORTS"]).rglob("*tokens.xml")) if PATHS else []


@needs_exports
@pytest.mark.parametrize("path", TOKENS or [Path("none")], ids=readable)
def test_what_epgs_target_makes_of_their_tokens(path: Path, tmp_path: Path) -> None:
    """20-sim with EPG's templates would export this: it compiles with strict warnings and gives the tokens' results."""
    from_tokens, diagnostics = load(path)
    if from_tokens is None and any("matrices" in i.message or i.id == "model-stub" for i in diagnostics):
        return
    assert from_tokens is not None
    model = loaded(generate_from(path, tmp_path / "export"))
    compile_export(tmp_path / "export", model.name, tmp_path)
    assert [(p.name, p.value, p.unit) for p in model.parameters] == [
        (p.name, p.value, p.unit) for p in from_tokens.parameters
    ]
    found = run_wrapper(build(model, "ours", tmp_path), STEPS)
    expected = run_wrapper(build(from_tokens, "tokens", tmp_path), STEPS)
    if from_tokens.version.startswith("4.5"):  # its Runge Kutta 4 adds in another order
        assert close(found, expected, 1e-6)
    else:
        assert not difference(found, expected)
