# SPDX-License-Identifier: Apache-2.0
"""Files that are a model, files that are not, and the messages about them."""

from __future__ import annotations

from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.generator.importers import load_model
from epg.generator.source import Span
from tests.doubles.twenty_sim.exports import Export
from tests.models.harness import load


def only_error(path: Path) -> tuple[str, str, str]:
    model, diagnostics = load(path)
    assert model is None
    assert len(diagnostics.items) == 1
    problem = diagnostics.items[0]
    assert problem.severity == "error" and problem.hint
    return problem.id, problem.message, problem.hint


def test_one_level_below(tmp_path: Path) -> None:
    Export().write(tmp_path / "export" / "Servo")
    assert load(tmp_path / "export")[0] is not None
    assert only_error(tmp_path)[0] == "model-not-recognised"


def test_a_file_of_the_model(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    for name in ("xxsubmod.c", "tokens.xml"):
        assert load(folder / name)[0] is not None
    assert only_error(folder / "xxmodel.c")[0] == "model-not-recognised"


def test_sources_go_before_tokens(tmp_path: Path) -> None:
    model, _ = load(Export().write(tmp_path))
    assert model is not None and model.origin == "20-sim C function"


def test_sources_of_an_fmu_need_something_that_names_the_ports(tmp_path: Path) -> None:
    folder = Export().write(tmp_path)
    (folder / "tokens.xml").unlink()
    path = folder / "xxsubmod.c"
    text = path.read_text().replace("XXDouble *u, XXDouble *y, ", "").replace("Variables (u);", "Variables (0);")
    path.write_text(text.replace("Outputs (y);", "Outputs (0);"))
    model, diagnostics = load(folder)
    assert model is None
    assert "model-ports" in {item.id for item in diagnostics}


def test_nothing_there(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    id, _, hint = only_error(tmp_path / "model")
    assert (id, hint) == ("model-not-found", "folders beside it: models")
    assert only_error(tmp_path / "a" / "b")[0] == "model-not-found"
    assert only_error(Path("\0"))[0] == "model-not-found"
    assert only_error(Path("x" * 5000))[0] == "model-not-found"


def test_empty_and_foreign_folders(tmp_path: Path) -> None:
    id, message, hint = only_error(tmp_path)
    assert id == "model-not-recognised" and "empty" in message and "xxsubmod.c" in hint
    (tmp_path / "Servo.emx").write_text("x")
    assert ".emx" in only_error(tmp_path)[2]
    (tmp_path / "Servo.emx").unlink()
    (tmp_path / "driver.c").write_text("int x;")
    assert "the folder has driver.c" in only_error(tmp_path)[2]


@pytest.mark.parametrize("data", [b"\0\1\2\3" * 100, b"\xff" * 1000, b"\x7fELF\2\1\1" + bytes(200)])
def test_garbage_files(data: bytes, tmp_path: Path) -> None:
    for name in ("xxsubmod.c", "Servo.cpp", "tokens.xml"):
        folder = tmp_path / name.replace(".", "_")
        folder.mkdir()
        (folder / name).write_bytes(data)
        model, diagnostics = load(folder)
        assert model is None and diagnostics.error_count == 1
        model, diagnostics = load(folder / name)
        assert model is None and diagnostics.error_count == 1


def test_an_endless_file(tmp_path: Path) -> None:
    (tmp_path / "xxsubmod.c").write_bytes(b"{" * (17 << 20))
    assert only_error(tmp_path / "xxsubmod.c")[0] == "model-unreadable"


def test_unreadable_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refuse)
    assert only_error(tmp_path)[0] == "model-unreadable"


def test_problems_with_the_path_stand_where_it_is_written(tmp_path: Path) -> None:
    diagnostics = Diagnostics()
    caller = Span("CMakeLists.txt", 7, 3, 9)
    assert load_model(tmp_path / "model", diagnostics, caller) is None
    assert diagnostics.items[0].span == caller


def test_dangling_and_looping_links(tmp_path: Path) -> None:
    folder = Export().write(tmp_path / "model")
    (folder / "xxlost.c").symlink_to(tmp_path / "nowhere")
    (folder / "loop").symlink_to(folder)
    assert load(folder)[0] is not None
