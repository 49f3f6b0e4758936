# SPDX-License-Identifier: Apache-2.0
"""``epg schema``: an editor with this schema gives the same verdict on a file as EPG."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from epg.cli.main import main
from epg.cli.schema import write_editor_schemas
from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.editor_schemas import TARGET_FILES, USER_FILES, editor_schema
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.yaml_file import load_yaml
from epg.generator.quantity import SPELLINGS, UNITS, QuantityError, parse_quantity, parse_ratio
from tests.errors.test_errors import CASES, COMMAND, lay_out, read_case

ROOT = Path(__file__).resolve().parent.parent.parent
EDITOR = ROOT / "schemas/editor"
NAMES = (*USER_FILES, *TARGET_FILES)
KEYWORDS = set(
    "$schema $id $ref $defs title description default examples type enum const properties propertyNames"
    " additionalProperties required dependentRequired minProperties maxProperties items minItems maxItems uniqueItems"
    " pattern minLength maxLength minimum maximum exclusiveMinimum exclusiveMaximum"
    " allOf anyOf oneOf not if then else".split()
)
"""The keywords of draft 2020-12 that the YAML and JSON extensions of editors support."""


def schema(name: str) -> dict[str, Any]:
    return editor_schema(name, load_catalog(targets_roots(), Diagnostics()), built_in=True)


SCHEMAS = {name: schema(name) for name in NAMES}
TCF = jsonschema.Draft202012Validator(SCHEMAS["tcf"])


def plain(path: Path) -> Any:
    node = load_yaml(path, Diagnostics())
    assert node is not None
    return node.plain()


def parts(value: Any) -> Iterator[dict[str, Any]]:
    """All schemas within a schema."""
    if not isinstance(value, dict):
        return
    if value and all(isinstance(child, dict) for child in value.values()):  # a group of definitions
        for child in value.values():
            yield from parts(child)
        return
    yield value
    for key, child in value.items():
        if key in ("properties", "$defs"):
            for inner in child.values():
                yield from parts(inner)
        elif key in ("allOf", "anyOf", "oneOf"):
            for inner in child:
                yield from parts(inner)
        elif key in ("items", "additionalProperties", "propertyNames", "not", "if", "then", "else"):
            yield from parts(child)


@pytest.mark.parametrize("name", NAMES)
def test_schemas_are_of_the_part_that_editors_understand(name: str) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMAS[name])
    for part in parts(SCHEMAS[name]):
        assert set(part) <= KEYWORDS, part
        for pattern in (part[key] for key in ("pattern",) if key in part):
            assert not re.search(r"\\[^.\\swd()\[\]/]|\(\?[^:]", pattern), (
                f"{pattern} is no regular expression of ECMA-262"
            )


def test_the_schemas_of_a_wheel_have_epgs_own_kinds_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path / "of the user"))
    write_editor_schemas(tmp_path / "schemas")
    written = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in (tmp_path / "schemas").iterdir()}
    assert written == {f"{name}.schema.json": SCHEMAS[name] for name in USER_FILES}


@pytest.mark.parametrize("path", sorted(ROOT.glob("targets/robots/*/*.tcf")), ids=lambda path: path.name)
def test_predefined_configurations_are_right(path: Path) -> None:
    TCF.validate(plain(path))


@pytest.mark.parametrize(
    ("name", "pattern"),
    [
        ("bindings", "examples/*/*bindings.yaml"),
        ("scenario", "examples/*/tracking.yaml"),
        ("model", "tests/models/*/model.yaml"),
        ("board", "targets/boards/*/board.yaml"),
        ("component", "targets/components/*/component.yaml"),
        ("family", "targets/families/*/family.yaml"),
        ("platform", "targets/platforms/*/platform.yaml"),
        ("soc", "targets/socs/*/soc.yaml"),
    ],
)
def test_files_of_this_repository_are_right(name: str, pattern: str) -> None:
    """EPG compares a file that extends another one with its schema after the merge."""
    files = [file for file in map(plain, sorted(ROOT.glob(pattern))) if "extends" not in file]
    assert files
    for file in files:
        jsonschema.Draft202012Validator(SCHEMAS[name]).validate(file)


def test_the_files_of_the_tests_of_messages_are_right() -> None:
    TCF.validate(plain(ROOT / "tests/errors/common/robot.tcf"))


STRUCTURE = {"unknown-key", "missing-key", "wrong-type", "wrong-unit", "wrong-quantity", "exactly-one", "only-with"}
STRUCTURE |= {"unknown-kind", "unknown-target", "unknown-middleware"}
"""Mistakes that a schema can detect; others need the model, the bindings or the pins."""
READABLE = re.compile(r"^robot\.tcf:\d+:\d+: error: .* \[([a-z-]+)\]$", re.MULTILINE)


def is_about_a_configuration(case: Path) -> bool:
    """True if ``robot.tcf`` is checked in the usual way, without the user's own kinds or boards."""
    command, files, _ = read_case(case)
    return command == COMMAND and not any(name.startswith("targets/") for name in files)


@pytest.mark.parametrize("case", filter(is_about_a_configuration, CASES), ids=lambda path: path.stem)
def test_editors_refuse_what_epg_refuses(case: Path, tmp_path: Path) -> None:
    """Of each golden case, the schema detects the mistakes of structure in ``robot.tcf``, and no others."""
    _, files, expected = read_case(case)
    found = set(READABLE.findall(expected))
    lay_out(tmp_path, files)
    node = load_yaml(tmp_path / "robot.tcf", Diagnostics())
    if node is None or not node.is_mapping:
        assert re.search("^robot.tcf", expected, re.MULTILINE), "it is no map, which EPG says"
        return
    errors = list(TCF.iter_errors(node.plain()))
    if found & STRUCTURE and "extends" not in node:
        assert errors
    if not found:
        assert not errors, "EPG finds nothing wrong with this file"


@pytest.mark.parametrize("dimension", sorted({dimension for dimension, _ in UNITS.values()} - {"ratio"}))
def test_quantities_are_those_that_epg_reads(dimension: str) -> None:
    from epg.generator.check.editor_schemas import _quantity_form

    form = re.compile(_quantity_form(dimension, "[-+]?"))
    for number in ("1", "-1.5", "+.5", "2.", "1e3", "1E-3", "1_0", "", "0x1", "1,5"):
        for unit in (*UNITS, *SPELLINGS, "furlong", "Ms"):
            for text in (f"{number} {unit}", f" {number}{unit} "):
                try:
                    parse_quantity(text, dimension)
                    right = True
                except QuantityError:
                    right = False
                assert (form.search(text) is not None) == right, text


@pytest.mark.parametrize("text", ["5625/361", "-1 / 2", " 1.5/2e3 ", "1/", "1/2/3", "a/b", "1", "+1/-2"])
def test_ratios_are_those_that_epg_reads(text: str) -> None:
    from epg.generator.check.editor_schemas import _ratio_form

    try:
        parse_ratio(text)
        right = True
    except QuantityError:
        right = False
    assert (re.search(_ratio_form("[-+]?"), text) is not None) == right


def complete(**changes: Any) -> dict[str, Any]:
    file: dict[str, Any] = plain(ROOT / "tests/errors/common/robot.tcf")
    return {**file, **changes}


def component(**keys: Any) -> dict[str, Any]:
    return complete(components={"it": keys})


@pytest.mark.parametrize(
    ("file", "right"),
    [
        (component(kind="constant", value=1), True),
        (component(kind="constant"), False),
        (component(kind="constants", value=1), False),
        (component(value=1), False),
        (component(kind="digital_input", pins={"value": 3}), True),
        (component(kind="digital_input", pins={"value": "GP3"}), True),
        (component(kind="digital_input", pins={}), False),
        (component(kind="digital_input"), False),
        (component(kind="digital_input", pins={"value": 3, "b": 4}), False),
        (component(kind="digital_input", pins={"value": 3}, pull="sideways"), False),
        (component(kind="digital_input", pins={"value": 3}, pull="up", invert=True, limits=[0, 1]), True),
        (component(kind="digital_input", pins={"value": 3}, limits=[0]), False),
        (component(kind="quadrature_encoder", pins={"a": 1, "b": 2}, span={"counts": 1, "angle": "1 deg"}), True),
        (component(kind="quadrature_encoder", pins={"a": 1, "b": 2}, span={"counts": 1}), False),
        (component(kind="quadrature_encoder", pins={"a": 1, "b": 2}, span={"counts": 1, "angle": "1 ms"}), False),
        (component(kind="quadrature_encoder", pins={"a": 1, "b": 2}), False),
        (component(kind="quadrature_encoder", pins={"a": 1, "b": 2}, counts_per_revolution=1, gear="3/2"), True),
        (component(kind="quadrature_encoder", pins={"a": 1, "b": 2}, counts_per_revolution=1, gear="3:2"), False),
        (component(kind="quadrature_encoder", pins={"a": 1, "b": 2}, counts_per_revolution=0), False),
        (complete(target="host", communication={"middleware": "files"}), True),
        (complete(target="host", communication={"middleware": "xrce"}), True),
        (complete(communication={"middleware": "dds"}), False),
        (complete(communication={"middleware": "xrce", "transport": "usb"}), True),
        (complete(communication={"middleware": "none", "transport": "usb"}), False),
        (complete(target="hots"), False),
        (complete(namespace=None), True),
        (complete(version=2), False),
        # the host numbers its pins itself
        (complete(target="host", components={"it": {"kind": "digital_input"}}, communication=None), True),
        # parts of a configuration
        ({"version": 1, "node": "robot", "components": {"it": {"kind": "pwm"}}}, True),
        ({"version": 1, "node": "robot", "components": {"it": {"kind": "pwm", "frequenzy": "1 kHz"}}}, False),
        ({"version": 1, "extends": "x.tcf", "target": "host", "components": {"it": {"pins": {"a": 1}}}}, True),
        ({"version": 1, "extends": "x.tcf", "components": {"it": {"pinz": {"a": 1}}}}, False),
        ({"version": 1, "extends": "x.tcf", "components": {"it": None, "other": {"frequency": None}}}, True),
        ({"version": 1, "extends": "x.tcf", "components": {"it": {"kind": "pwm", "frequency": None}}}, True),
    ],
)
def test_configurations(file: dict[str, Any], right: bool) -> None:
    assert TCF.is_valid(file) == right


def test_kinds_come_with_what_editors_show() -> None:
    definitions = SCHEMAS["tcf"]["$defs"]
    encoder = definitions["quadrature_encoder"]["properties"]
    assert encoder["preset"]["default"] == "0 rad"
    assert "after x4 decoding" in encoder["counts_per_revolution"]["description"]
    assert definitions["ros_subscriber"]["properties"]["on_timeout"]["enum"][:3] == ["hold", "zero", "disable"]
    kinds = definitions["component"]["properties"]["kind"]
    assert "quadrature_encoder" in kinds["enum"]
    assert "pwm_h_bridge: an H-bridge" in kinds["description"]


def test_kinds_and_boards_of_the_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    kind = tmp_path / "mine/components/servo"
    kind.mkdir(parents=True)
    (kind / "code.c.j2").write_text("")
    (kind / "component.yaml").write_text(
        "api: 1\nkind: servo\nsummary: a model servo\n"
        "parameters: {speed: {quantity: angular velocity, required: true, description: at no load}}\n"
        "ports: {angle: {direction: sink, type: real, default: true}}\n"
    )
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path / "mine"))
    assert main(["schema"]) == 0
    composed = json.loads(capsys.readouterr().out)
    assert "$id" not in composed, "it is not the public one"
    validator = jsonschema.Draft202012Validator(composed)
    assert validator.is_valid(component(kind="servo", speed="60 rpm"))
    assert not validator.is_valid(component(kind="servo", speed="60 Hz"))
    assert not validator.is_valid(component(kind="servo"))
    assert not TCF.is_valid(component(kind="servo", speed="60 rpm"))


def test_mistakes_in_the_user_s_folders_are_reported(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    kind = tmp_path / "mine/components/servo"
    kind.mkdir(parents=True)
    (kind / "component.yaml").write_text("api: 1\nkind: servo\n")
    monkeypatch.setenv("EPG_TARGETS_PATH", str(tmp_path / "mine"))
    assert main(["schema", "-o", str(tmp_path / "tcf.json")]) == 1
    assert "'summary' is missing" in capsys.readouterr().err
    assert not (tmp_path / "tcf.json").exists()


def test_files_are_written_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "build/schemas"
    assert main(["schema", "--folder", str(folder), "--json"]) == 0
    assert sorted(json.loads(capsys.readouterr().out)["written"]) == sorted(f"{n}.schema.json" for n in NAMES)
    assert sorted(path.name for path in folder.iterdir()) == sorted(f"{n}.schema.json" for n in NAMES)
    assert main(["schema", "--folder", str(folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["written"] == []
    assert main(["schema", "bindings", "-o", str(tmp_path / "b.json")]) == 0
    assert (tmp_path / "b.json").read_bytes() == (folder / "bindings.schema.json").read_bytes()


def test_wrong_command_lines(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema", "tfc"]) == 2
    assert "there is no kind of file 'tfc'" in capsys.readouterr().err
    assert main(["schema", "tcf", "bindings"]) == 2
    assert main(["schema", "tcf", "-o", "x", "--folder", "y"]) == 2


MODELINE = re.compile(r"^# yaml-language-server: \$schema=(\S+)$", re.MULTILINE)


@pytest.mark.parametrize("tree", ["targets/robots", "examples"])
def test_files_name_their_schema(tree: str) -> None:
    """By a path that is valid in a checkout, and for ``targets`` also in a wheel."""
    for path in sorted((ROOT / tree).glob("*/*")):
        kind = path.suffixes[-2] if path.suffix == ".yaml" and len(path.suffixes) > 1 else ""
        name = {".tcf": "tcf", ".yaml": kind.removeprefix(".") or "scenario"}.get(path.suffix)
        if name is not None:
            found = MODELINE.search(path.read_text(encoding="utf-8"))
            assert found, path
            assert (path.parent / found[1]).resolve() == EDITOR / f"{name}.schema.json"
