# SPDX-License-Identifier: Apache-2.0
"""Configurations that are composed of a target, a robot and a wiring: no file is needed for each of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.composed_tcf import composed_tcf
from epg.generator.documents.tcf import find_tcf, load_tcf_chain
from epg.generator.project import Request, load_configuration
from epg.generator.resolve.first_fit import signals_of

ROOT = Path(__file__).resolve().parent.parent.parent
BOARD = "api: 1\nboard: motor_board\nsummary: ours\nsoc: rp2040\npins: [0-15, 26-29]\nprefixes: [GP]\n"


@pytest.mark.parametrize(
    ("name", "files"),
    [
        ("rpi_pico2_w_zephyr_jiwy", ["rpi_pico_jiwy", "jiwy"]),
        ("nucleo_f767zi_zephyr_jiwy.tcf", ["nucleo_h743zi_jiwy", "jiwy"]),
        (
            "nucleo_f767zi_freertos_jiwy",
            ["nucleo_h743zi_freertos_jiwy", "nucleo_h743zi_stlink_jiwy", "nucleo_h743zi_jiwy"],
        ),
        ("host_relbot", ["relbot"]),
        ("motor_board_zephyr_relbot", ["relbot"]),
    ],
)
def test_a_composed_configuration_extends_the_nearest_wiring(name: str, files: list[str], tmp_path: Path) -> None:
    chain = load_tcf_chain(name, targets_roots([user_folder(tmp_path)]), Diagnostics())
    assert [file.path.stem for file in chain][1 : 1 + len(files)] == files
    assert [file.is_composed for file in chain] == [True] + [False] * (len(chain) - 1)
    assert chain[0].node["target"].value == name.removesuffix(".tcf").rpartition("_")[0]


@pytest.mark.parametrize(
    "name", ["host_robot", "pico_jiwy", "rpi_pico_jiwi", "no_board_zephyr_jiwy", "_jiwy", "zephyr"]
)
def test_other_names_compose_nothing(name: str) -> None:
    assert composed_tcf(name, targets_roots()) is None


def user_folder(folder: Path) -> Path:
    board = folder / "targets/boards/motor_board/board.yaml"
    board.parent.mkdir(parents=True, exist_ok=True)
    board.write_text(BOARD)
    return folder / "targets"


def test_a_file_of_the_user_replaces_a_composed_one_and_cmake_sees_that_it_appears(tmp_path: Path) -> None:
    roots = targets_roots([user_folder(tmp_path)])
    name, robots = "motor_board_bare_metal_jiwy.tcf", tmp_path / "targets/robots/jiwy"
    wiring, own = robots / "motor_board_jiwy.tcf", robots / name
    assert {wiring, own} <= {path for file in load_tcf_chain(name, roots, Diagnostics()) for path in file.absent}
    robots.mkdir(parents=True)
    wiring.write_text("version: 1\nextends: jiwy.tcf\n")
    assert [file.path for file in load_tcf_chain(name, roots, Diagnostics())][:2] == [own, wiring]
    own.write_text("version: 1\nextends: jiwy.tcf\ntarget: host\n")
    chain = load_tcf_chain(name, roots, Diagnostics())
    assert (find_tcf(name, tmp_path, roots), chain[0].is_composed) == (own, False)


def test_a_new_board_gets_its_wiring_into_the_file_of_the_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """No file per robot: ``epg new`` writes pins that fit, and a configuration without them is an error."""
    monkeypatch.setenv("EPG_TARGETS_PATH", str(user_folder(tmp_path)))
    monkeypatch.chdir(tmp_path)
    name = "motor_board_bare_metal_jiwy"
    assert f"{name}.tcf" in load_catalog(targets_roots([tmp_path / "targets"]), Diagnostics()).configuration_names()
    assert main(["check", f"{name}.tcf"]) == 1
    assert capsys.readouterr().err.count("[unwired]") == 4
    assert main(["new", "jiwy", "--target", name, "--model", str(ROOT / "examples/jiwy/model")]) == 0
    request = Request("jiwy", "jiwy/jiwy.tcf", Path(), Path(), user_roots=[tmp_path / "targets"])
    configuration = load_configuration(request, load_catalog(request.roots, Diagnostics()), Diagnostics())
    pins = list(signals_of(configuration).values())
    assert (len(pins), len(set(pins))) == (10, 10)
    assert "  encoder_pan: {pins: {a: GP0, b: GP1}}\n" in (tmp_path / "jiwy/jiwy.tcf").read_text(encoding="utf-8")
