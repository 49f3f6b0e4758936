# SPDX-License-Identifier: Apache-2.0
"""Files of a model beside its folder: the used files, the ignored files, and the messages."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostic
from epg.generator.models import neighbours
from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import HAVE_COMPILER, build, load, loaded, run_wrapper

SHARED_C = ("xxtypes.h", "xxfuncs.h", "xxfuncs.c", "xxinteg.h", "xxinteg.c")


def share(folder: Path, names: tuple[str, ...], place: Path) -> None:
    """Moves files out of a model's folder."""
    place.mkdir(exist_ok=True)
    for name in names:
        shutil.move(folder / name, place / name)


def c_model(folder: Path, place: Path) -> Path:
    made = Export().write(folder)
    share(made, SHARED_C, place)
    return made


def only(folder: Path) -> Diagnostic:
    """The first error about a model that cannot be loaded; all errors must be of one kind."""
    model, diagnostics = load(folder)
    assert model is None
    errors = [item for item in diagnostics if item.severity == "error"]
    assert len({item.id for item in errors}) == 1, [item.message for item in errors]
    return errors[0]


@pytest.mark.parametrize("place", ["common", "include", "my own", "."])
def test_c_files_in_a_folder_beside_it_or_in_the_one_above(tmp_path: Path, place: str) -> None:
    folder = c_model(tmp_path / "robot" / "pan", tmp_path / "robot" / place)
    model, diagnostics = load(folder)
    assert model is not None
    assert {path.name for path in model.files if path.parent == tmp_path / "robot" / place} == set(SHARED_C)
    notes = [item for item in diagnostics if item.id == "model-neighbour"]
    assert [(item.severity, item.span.file) for item in notes] == [("note", str(folder / "xxsubmod.c"))]
    assert f"'{'..' if place == '.' else '../' + place}'" in notes[0].message
    assert all(name in notes[0].message for name in SHARED_C)


@pytest.mark.skipif(not HAVE_COMPILER, reason="needs gcc and g++")
@pytest.mark.parametrize("language", ["c", "c++"])
def test_the_numbers_are_those_of_the_whole_export(tmp_path: Path, language: str) -> None:
    export = Export(method="RungeKutta4")
    write = export.write if language == "c" else export.write_cpp
    whole, folder = write(tmp_path / "whole"), write(tmp_path / "robot" / "pan")
    if language == "c":
        share(folder, SHARED_C, tmp_path / "robot" / "common")
    else:
        shutil.move(folder / "common", tmp_path / "robot" / "common")
    expected = run_wrapper(build(loaded(whole), "whole", tmp_path / "build"), 20)
    assert run_wrapper(build(loaded(folder), "pan", tmp_path / "build"), 20) == expected


@pytest.mark.skipif(not HAVE_COMPILER, reason="needs gcc and g++")
def test_a_class_whose_header_is_included_by_its_place(tmp_path: Path) -> None:
    folder = Export().write_cpp(tmp_path / "pan")
    shutil.move(folder / "common", tmp_path / "common")
    for path in (folder / "Servo.h", folder / "Servo.cpp"):
        path.write_text(path.read_text().replace('"common/', '"../common/'))
    model, diagnostics = load(folder)
    assert model is not None and (tmp_path / "common" / "xxinteg.cpp") in model.files
    assert [item.severity for item in diagnostics] == ["note"]
    run_wrapper(build(model, "pan", tmp_path / "build"), 2)


def test_a_class_without_its_functions_does_not_reach_the_linker(tmp_path: Path) -> None:
    folder = Export().write_cpp(tmp_path / "pan")
    (folder / "common" / "xxinteg.cpp").unlink()
    problem = only(folder)
    assert problem.id == "model-incomplete" and "'Discrete' is declared in 'xxinteg.h'" in problem.message
    assert Path(problem.span.file).parent == folder and "'pan' and its subfolders" in problem.hint


def test_files_in_the_models_folder_count_first(tmp_path: Path) -> None:
    folder = Export().write(tmp_path / "pan")
    (tmp_path / "common").mkdir()
    for name in SHARED_C:
        (tmp_path / "common" / name).write_text("#error this is another one\n")
    model, diagnostics = load(folder)
    assert model is not None and not diagnostics.items and not model.searched


def test_files_that_differ_are_not_chosen_from(tmp_path: Path) -> None:
    folder = c_model(tmp_path / "pan", tmp_path / "common")
    (tmp_path / "old").mkdir()
    text = (tmp_path / "common" / "xxtypes.h").read_text()
    (tmp_path / "old" / "xxtypes.h").write_text("/* of 2019 */\r\n" + text.replace("\n", "\r\n"))
    model = loaded(folder)  # both have the same contents
    twins = [tmp_path / "common" / "xxtypes.h", tmp_path / "old" / "xxtypes.h"]
    assert [path for path in model.considered if path.name == "xxtypes.h"] == twins
    (tmp_path / "old" / "xxtypes.h").write_text(text.replace("double", "float"))
    problem = only(folder)
    assert problem.id == "model-ambiguous-definition" and "'xxtypes.h'" in problem.message
    assert [note.span.file for note in problem.notes] == [str(path) for path in twins]


def test_functions_that_differ_are_not_chosen_from(tmp_path: Path) -> None:
    folder = c_model(tmp_path / "pan", tmp_path / "common")
    (tmp_path / "old").mkdir()
    text = (tmp_path / "common" / "xxinteg.c").read_text()
    (tmp_path / "old" / "xxinteg.c").write_text(text + "int XXother;\n")
    assert tmp_path / "common" / "xxinteg.c" in loaded(folder).files  # it is beside its header
    shutil.move(tmp_path / "common" / "xxinteg.h", folder / "xxinteg.h")
    shutil.move(tmp_path / "common" / "xxtypes.h", folder / "xxtypes.h")
    shutil.move(tmp_path / "common" / "xxfuncs.h", folder / "xxfuncs.h")
    problem = only(folder)
    assert problem.id == "model-ambiguous-definition" and len(problem.notes) == 2


def test_files_of_another_model_are_named_and_not_used(tmp_path: Path) -> None:
    other = Export(name="Tilt").write(tmp_path / "tilt")
    folder = Export().write(tmp_path / "pan")
    (folder / "xxmodel.h").unlink()
    problem = only(folder)
    assert problem.id == "model-file-missing" and "EPG has searched 'pan' and its subfolders" in problem.hint
    assert [note.message for note in problem.notes] == ["a file of this name, of another model"]
    assert problem.notes[0].span.file == str(other / "xxmodel.h")


def test_what_the_model_does_not_use_stays_out(tmp_path: Path) -> None:
    folder = c_model(tmp_path / "pan", tmp_path / "common")
    (tmp_path / "common" / "driver.c").write_text('#include "nothing.h"\nint XXUnused(void) { return 1; }\n')
    (tmp_path / "common" / "main.c").write_text("double XXInitialize(void) { return 1; } int main(void) { return 0; }")
    assert not {"driver.c", "main.c"} & {path.name for path in loaded(folder).files}


def test_places_that_are_not_searched(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = c_model(tmp_path / "pan", tmp_path / "common")
    assert load(folder)[0] is not None
    with monkeypatch.context() as patch:
        patch.setenv("HOME", str(tmp_path))
        patch.setenv("USERPROFILE", str(tmp_path))
        assert "a home folder" in only(folder).hint
    with monkeypatch.context() as patch:
        patch.setattr(neighbours, "MAX_ENTRIES", 1)
        assert "more than 1 entries" in only(folder).hint
    tmp_path.chmod(0o777)
    assert "all users can write" in only(folder).hint
    tmp_path.chmod(0o700)
    (tmp_path / "common").rename(tmp_path / "common[")  # CMake cannot have this name in a list
    assert only(folder).id == "model-file-missing"


def test_links_are_not_followed(tmp_path: Path) -> None:
    folder = c_model(tmp_path / "robot" / "pan", tmp_path / "elsewhere")
    (tmp_path / "robot" / "common").symlink_to(tmp_path / "elsewhere")
    assert only(folder).id == "model-file-missing"


def test_from_inside_the_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = c_model(tmp_path / "pan", tmp_path / "common")
    monkeypatch.chdir(folder)
    model, diagnostics = load(Path("."))
    assert model is not None and Path("../common/xxtypes.h") in model.files
    assert "'../common'" in diagnostics.items[0].message


def test_sources_in_src_and_shared_ones_beside_the_model(tmp_path: Path) -> None:
    folder = Export().write(tmp_path / "pan" / "src")
    (tmp_path / "pan" / "include").mkdir()
    shutil.move(folder / "xxmodel.h", tmp_path / "pan" / "include" / "xxmodel.h")
    share(folder, SHARED_C, tmp_path / "common")
    model, diagnostics = load(tmp_path / "pan")
    assert model is not None
    assert [item.message.split(",")[0] for item in diagnostics] == ["these files are from '../../common'"]


def test_a_header_in_another_spelling(tmp_path: Path) -> None:
    folder = c_model(tmp_path / "pan", tmp_path / "common")
    (tmp_path / "common" / "xxtypes.h").rename(tmp_path / "common" / "XXTypes.h")
    model, _ = load(folder)
    assert model is not None and (tmp_path / "common" / "XXTypes.h") in model.files


@pytest.mark.skipif(not HAVE_COMPILER, reason="needs gcc and g++")
def test_the_common_folder_of_another_class(tmp_path: Path) -> None:
    export = Export(method="Euler")
    export.write_cpp(tmp_path / "robot" / "tilt")
    folder, whole = export.write_cpp(tmp_path / "robot" / "pan"), export.write_cpp(tmp_path / "whole")
    shutil.rmtree(folder / "common")
    model, diagnostics = load(folder)
    assert model is not None
    assert [item.message.split(",")[0] for item in diagnostics] == ["these files are from '../tilt/common'"]
    expected = run_wrapper(build(loaded(whole), "whole", tmp_path / "build"), 20)
    assert run_wrapper(build(model, "pan", tmp_path / "build"), 20) == expected


def test_a_function_that_another_model_defines(tmp_path: Path) -> None:
    other = Export(name="Tilt").write(tmp_path / "tilt")
    folder = Export(method="Euler").write(tmp_path / "pan")
    (folder / "xxmodel.c").unlink()
    model, diagnostics = load(folder)
    assert model is None
    problem = next(item for item in diagnostics if "'XXModelInitialize'" in item.message)
    assert problem.id == "model-incomplete" and problem.hint.startswith("EPG has searched 'pan' and its subfolders;")
    assert [note.span.file for note in problem.notes] == [str(other / "xxmodel.c")]
