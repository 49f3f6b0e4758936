# SPDX-License-Identifier: Apache-2.0
"""`epg connect` in a window after an export, for the folder that 20-sim has written."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.connect.started import started
from tests.doubles.twenty_sim.exports import Export
from tests.twenty_sim.generate import FOLDER, PERSONAL, ROOT, generate, tokens_of

EPG = [sys.executable, str(ROOT / "epg")]


def exported(folder: Path, *options: str) -> list[str]:
    return [*EPG, "exported", *options, str(folder)]


def export_into(folder: Path, export: Export | None = None) -> Path:
    return generate(tokens_of(export or Export()), folder)


def test_without_a_window_nothing_is_started(tmp_path: Path) -> None:
    """A script of 20-sim waits for the command file, which therefore must not open a window."""
    done = subprocess.run(exported(export_into(tmp_path)), capture_output=True, text=True, timeout=60, check=True)
    assert "http" not in done.stdout and f'epg connect "{tmp_path}"' in done.stdout


def test_a_project_begins_with_the_export(tmp_path: Path) -> None:
    folder = export_into(tmp_path / "My (x86) exports & more" / "100% $HOME %PATH% ^ ! Servo (1)")
    with started(exported(Path("."), "--connect"), folder) as (page, process):
        state = page.state()
        assert (state["phase"], state["model"]["name"]) == ("choose", "Servo")
        assert Path(state["create"]["folder"]).parent == folder.parent
        said = json.dumps(state).lower()
        assert not [value for value in ("doe", *PERSONAL.values()) if value.lower() in said]
        assert "host" in [c["name"] for c in page.until(lambda state: state["configurations"])["configurations"]]
        state = page.post("create", configuration="host", folder=str(folder.parent / "My 50% $x"), name="servo")
        assert state["phase"] == "connect"
        page.post("done")
        process.communicate(timeout=30)
        assert process.returncode == 0
    texts = [path.read_text("utf-8").lower() for path in (folder.parent / "My 50% $x").rglob("*") if path.is_file()]
    assert texts and not [text for text in texts if "doe" in text.replace("does", "")]


def test_the_project_that_has_the_folder_is_opened(tmp_path: Path) -> None:
    """A second export into the folder that is a project's model: the page shows the new port."""
    made = [*EPG, "new", "--target", "host", "--model", str(export_into(tmp_path / "once")), str(tmp_path / "servo")]
    subprocess.run(made, check=True, capture_output=True)
    model = export_into(tmp_path / "servo" / "model", Export(inputs=(*Export().inputs, ("brake", "none"))))
    with started(exported(model, "--connect")) as (page, _):
        state = page.state()
        assert (state["phase"], state["project"]["name"]) == ("connect", "servo")
        assert [d["port"] for d in state["diagnostics"] if d["id"] == "unbound-input"] == ["brake"]


def test_a_model_that_cannot_be_used_opens_nothing(tmp_path: Path) -> None:
    folder = export_into(tmp_path)
    (folder / "Servo.c").unlink()
    done = subprocess.run(exported(folder, "--connect"), capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 1 and "http" not in done.stdout and ": error: " in done.stderr


def test_only_a_window_asks_for_the_page() -> None:
    text = (FOLDER / "open_in_epg.cmd").read_text()
    assert 'if "%~1"=="window" set "epg_option= --connect"' in text and text.count("--connect") == 1


@pytest.mark.parametrize("option", ["--json"])
def test_programs_get_data_and_no_page(option: str, tmp_path: Path) -> None:
    command = exported(export_into(tmp_path), option, "--connect")
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert json.loads(done.stdout)["name"] == "Servo"
