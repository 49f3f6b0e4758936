# SPDX-License-Identifier: Apache-2.0
"""The hash of an application is the same for the same behaviour, and differs for any other behaviour."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from epg.generator.data import data_folder
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.cmake import PathNames
from epg.generator.emit.outputs import application_outputs
from epg.generator.project import Request, load_application

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "jiwy"
ROBOTS = data_folder("targets") / "robots" / "jiwy"


def copy(folder: Path) -> Path:
    """JIWY's files, all in one folder."""
    shutil.copytree(EXAMPLE, folder)
    for file in ROBOTS.glob("*.tcf"):
        shutil.copy(file, folder)
    return folder


def generate(folder: Path, *settings: str, name: str = "jiwy", roots: tuple[Path, ...] = ()) -> dict[str, str]:
    from epg.generator.source import Span

    request = Request(
        name,
        tcf="host_jiwy.tcf",
        model=folder / "model",
        bindings=folder / "jiwy.bindings.yaml",
        plant=folder / "plant",
        plant_bindings=folder / "plant.bindings.yaml",
        settings=[(setting, Span("test")) for setting in settings],
        user_roots=roots,
        beside=folder,
    )
    diagnostics = Diagnostics()
    app = load_application(request, diagnostics)
    assert app is not None, [p.message for p in diagnostics]
    return application_outputs(app, request.roots, PathNames(folder))


def hash_of(files: dict[str, str]) -> str:
    found = re.search(r'_HASH "([0-9a-f]{16})"', files["jiwy_version.h"])
    assert found is not None
    return found[1]


def replaced(old: str, new: str) -> Callable[[Path], None]:
    def edit(path: Path) -> None:
        text = path.read_text(encoding="utf-8")
        assert old in text, old
        path.write_text(text.replace(old, new, 1), encoding="utf-8")

    return edit


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> str:
    return hash_of(generate(copy(tmp_path_factory.mktemp("original") / "jiwy")))


def test_it_is_in_all_that_names_it(tmp_path: Path) -> None:
    files = generate(copy(tmp_path / "jiwy"))
    hash = hash_of(files)
    assert f'#define JIWY_HASH "{hash}"' in files["jiwy_version.h"]
    assert f'"hash": "{hash}"' in files["jiwy.json"]
    assert hash not in files["jiwy.h"] + files["jiwy_app.c"]  # a change would compile these files again
    assert not any("\ue000" in text for text in files.values())


@pytest.mark.parametrize(
    ("file", "edit"),
    [
        ("jiwy.tcf", replaced("node: JIWY_node", "# a comment\nnode: JIWY_node   # and another")),
        ("jiwy.tcf", replaced("period: 33 ms", "period: 0.033 s")),
        ("jiwy.bindings.yaml", lambda path: path.write_text(f"# mine\n{path.read_text()}\n\n")),
        ("jiwy.bindings.yaml", lambda path: path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))),
    ],
)
def test_what_changes_nothing(original: str, tmp_path: Path, file: str, edit: Callable[[Path], None]) -> None:
    folder = copy(tmp_path / "elsewhere")
    edit(folder / file)
    assert hash_of(generate(folder)) == original


def test_line_ends_of_sources_change_nothing(original: str, tmp_path: Path) -> None:
    folder = copy(tmp_path / "jiwy")
    for source in folder.glob("model/**/*.[ch]"):
        source.write_bytes(source.read_bytes().replace(b"\n", b"\r\n"))
    assert hash_of(generate(folder)) == original


@pytest.mark.parametrize(
    "setting",
    [
        "node=other",
        "namespace=/robot1",
        "control.overrun_limit=11",
        "control.enable_at_start=true",
        "control.output_delay=500 us",
        "control.period=500 us",
        "communication.period=34 ms",
        "communication.middleware=none",
        "communication.jog_duty=0.3",
        "components.pwm_pan.max_duty=0.9",
        "components.encoder_tilt.span.counts=222",
        "components.pan_subscriber.timeout=1 s",
        "components.pan_publisher.qos=reliable",
    ],
)
def test_what_changes_behaviour(original: str, tmp_path: Path, setting: str) -> None:
    assert hash_of(generate(copy(tmp_path / "jiwy"), setting)) != original


@pytest.mark.parametrize(
    ("file", "more"), [("model/xxsubmod.c", "/* something */\n"), ("plant/tokens.xml", "<!-- something -->\n")]
)
def test_the_sources_of_models(original: str, tmp_path: Path, file: str, more: str) -> None:
    folder = copy(tmp_path / "jiwy")
    with (folder / file).open("a", encoding="utf-8") as source:
        source.write(more)
    assert hash_of(generate(folder)) != original


def test_the_code_of_kinds(original: str, tmp_path: Path) -> None:
    """A user's own kind, with the same name or another, is part of the firmware."""
    folder = copy(tmp_path / "jiwy")
    roots = tmp_path / "targets"
    kind = roots / "components" / "quadrature_encoder"
    shutil.copytree(data_folder("targets") / "components" / "quadrature_encoder", kind)
    assert hash_of(generate(folder, roots=(roots,))) == original
    replaced("epg_less(0.5, signal)", "epg_less(0.6, signal)")(kind / "quadrature_encoder.h")
    assert hash_of(generate(folder, roots=(roots,))) != original


def test_stored_parameters_belong_to_a_model_and_its_values(tmp_path: Path) -> None:
    def model_of(files: dict[str, str]) -> str:
        found = re.search(r"\.model = (0x[0-9a-f]{16}u),", files["jiwy_app.c"])
        assert found is not None
        return found[1]

    folder = copy(tmp_path / "jiwy")
    model = model_of(generate(folder))
    assert model_of(generate(folder, "node=other", "components.pwm_pan.max_duty=0.9")) == model
    source = folder / "model/xxsubmod.c"
    written = source.read_text()
    source.write_text(f"{written}/* something */\n")
    assert model_of(generate(folder)) != model
    source.write_text(written)
    bindings = folder / "jiwy.bindings.yaml"
    bindings.write_text(bindings.read_text() + "parameters:\n  Pan\\PID\\kp: 2.5\n")
    assert model_of(generate(folder)) != model
