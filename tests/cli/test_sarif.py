# SPDX-License-Identifier: Apache-2.0
"""``epg check --format``: SARIF for continuous integration, as the standard requires."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any
from urllib.parse import urlparse

import jsonschema
import pytest

from epg.cli.main import main
from epg.cli.messages import find_entry

ROOT = Path(__file__).resolve().parent.parent.parent
FILES = ["--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml"]

_MESSAGE = {"type": "object", "properties": {"text": {"type": "string", "minLength": 1}}, "required": ["text"]}
_POSITIVE = {"type": "integer", "minimum": 1}
_LOCATION = {
    "type": "object",
    "properties": {
        "id": {"type": "integer", "minimum": 0},
        "message": _MESSAGE,
        "physicalLocation": {
            "type": "object",
            "properties": {
                "artifactLocation": {
                    "type": "object",
                    "properties": {"uri": {"type": "string", "pattern": "^[^\\\\ ]+$"}},
                    "required": ["uri"],
                    "additionalProperties": False,
                },
                "region": {
                    "type": "object",
                    "properties": {"startLine": _POSITIVE, "startColumn": _POSITIVE, "endColumn": _POSITIVE},
                    "required": ["startLine"],
                    "additionalProperties": False,
                },
            },
            "required": ["artifactLocation"],
            "additionalProperties": False,
        },
        "logicalLocations": {"type": "array", "minItems": 1},
    },
    "additionalProperties": False,
}
SARIF = {
    "type": "object",
    "properties": {
        "$schema": {"type": "string"},
        "version": {"const": "2.1.0"},
        "runs": {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "properties": {
                    "tool": {
                        "type": "object",
                        "properties": {
                            "driver": {
                                "type": "object",
                                "properties": {
                                    "name": {"type": "string"},
                                    "semanticVersion": {"type": "string", "pattern": r"^\d+\.\d+\.\d+"},
                                    "informationUri": {"type": "string"},
                                    "rules": {
                                        "type": "array",
                                        "items": {
                                            "type": "object",
                                            "properties": {
                                                "id": {"type": "string"},
                                                "shortDescription": _MESSAGE,
                                                "fullDescription": _MESSAGE,
                                                "help": _MESSAGE,
                                                "helpUri": {"type": "string"},
                                            },
                                            "required": ["id", "shortDescription", "helpUri"],
                                            "additionalProperties": False,
                                        },
                                    },
                                },
                                "required": ["name"],
                                "additionalProperties": False,
                            }
                        },
                        "required": ["driver"],
                    },
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "results": {
                        "type": "array",
                        "items": {
                            "type": "object",
                            "properties": {
                                "ruleId": {"type": "string"},
                                "ruleIndex": {"type": "integer", "minimum": 0},
                                "level": {"enum": ["none", "note", "warning", "error"]},
                                "message": _MESSAGE,
                                "locations": {"type": "array", "items": _LOCATION},
                                "relatedLocations": {"type": "array", "items": _LOCATION},
                            },
                            "required": ["message", "ruleId", "level", "locations"],
                            "additionalProperties": False,
                        },
                    },
                },
                "required": ["tool", "results"],
                "additionalProperties": False,
            },
        },
    },
    "required": ["version", "runs"],
    "additionalProperties": False,
}
"""The requirements of SARIF 2.1.0 (3.13 to 3.30, 3.49) on the parts of a log that EPG writes, and on no others."""


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The files for tests of messages, in the current folder."""
    shutil.copytree(ROOT / "tests/errors/common", tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def change(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new), encoding="utf-8")


def sarif(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    """The single run in the printed log."""
    log = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator(SARIF).validate(log)
    run: dict[str, Any] = log["runs"][0]
    rules = run["tool"]["driver"]["rules"]
    assert len({rule["id"] for rule in rules}) == len(rules)
    for rule in rules:
        assert urlparse(rule["helpUri"]).scheme == "https"
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
        for place in result["locations"] + result.get("relatedLocations", []):
            region = place.get("physicalLocation", {}).get("region", {})
            assert region.get("endColumn", 1) > region.get("startColumn", 0)
    return run


def test_no_problem_is_a_log_without_results(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--format=sarif", *FILES]) == 0
    assert sarif(capsys)["results"] == []


def test_errors_have_places_rules_and_status_1(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change(robot / "robot.tcf", "period: 1 ms", "perid: 1 ms")
    assert main(["check", "--format=sarif", *FILES]) == 1
    run = sarif(capsys)
    (result,) = run["results"]
    assert result["message"]["text"] == "unknown key 'perid' in 'control'\nhint: did you mean 'period'?"
    assert result["level"] == "error"
    assert result["locations"] == [
        {
            "physicalLocation": {
                "artifactLocation": {"uri": "robot.tcf"},
                "region": {"startLine": 4, "startColumn": 11, "endColumn": 16},
            }
        }
    ]
    (rule,) = run["tool"]["driver"]["rules"]
    entry = find_entry("unknown-key")
    assert entry is not None
    assert rule["helpUri"].endswith("/docs/errors.md#unknown-key")
    assert rule["shortDescription"]["text"] == entry.summary
    assert rule["help"]["text"] == entry.text


def test_warnings_alone_are_status_0(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change(robot / "bindings.yaml", "  log: position\n", "")
    assert main(["check", "--format=sarif", *FILES]) == 0
    assert {(result["ruleId"], result["level"]) for result in sarif(capsys)["results"]} == {
        ("unbound-output", "warning"),
        ("unused-component", "warning"),
    }


def test_notes_are_related_places(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change(robot / "robot.tcf", "direction_a: 7", "direction_a: 10")
    assert main(["check", "--format=sarif", *FILES]) == 1
    (result,) = sarif(capsys)["results"]
    (related,) = result["relatedLocations"]
    assert related["message"]["text"] == "used here"
    assert related["physicalLocation"]["region"]["startLine"] == 6


def test_files_elsewhere_and_odd_names(
    robot: Path, tmp_path_factory: pytest.TempPathFactory, capsys: pytest.CaptureFixture[str]
) -> None:
    """Paths below the current folder are relative and percent-encoded; other paths are ``file://`` URIs."""
    odd = robot / "my robots" / "é: 100%.tcf"
    odd.parent.mkdir()
    other = tmp_path_factory.mktemp("other") / "other.tcf"
    for file in (odd, other):
        file.write_text("version: 1\n", encoding="utf-8")
    assert main(["check", "--format=sarif", str(odd), str(other)]) == 1
    uris = {
        place["physicalLocation"]["artifactLocation"]["uri"]
        for result in sarif(capsys)["results"]
        for place in result["locations"]
    }
    assert uris == {"my%20robots/%C3%A9%3A%20100%25.tcf", other.as_uri()}


def test_a_value_of_the_command_line_is_in_no_file(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--format=sarif", *FILES, "--set", "control.perod=1 ms"]) == 1
    (result,) = sarif(capsys)["results"]
    assert result["locations"] == [
        {"logicalLocations": [{"fullyQualifiedName": "control.perod=1 ms", "kind": "parameter"}]}
    ]


def test_a_missing_file_has_no_line(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--format=sarif", "--bindings", "nothing.yaml"]) == 1
    (result,) = sarif(capsys)["results"]
    assert result["locations"] == [{"physicalLocation": {"artifactLocation": {"uri": "nothing.yaml"}}}]


def test_messages_stay_on_the_error_stream(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    change(robot / "robot.tcf", "period: 1 ms", "perid: 1 ms")
    main(["check", "--format=sarif", *FILES])
    assert "robot.tcf:4:11: error: unknown key 'perid'" in capsys.readouterr().err


def test_the_other_formats(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--format=text", *FILES]) == 0
    assert capsys.readouterr().out == "no errors\n"
    assert main(["check", "--format=json", *FILES]) == 0
    assert json.loads(capsys.readouterr().out) == {"diagnostics": []}
    assert main(["check", "--format=xml", *FILES]) == 2
    assert main(["check", "--format=sarif"]) == 2
    assert capsys.readouterr().out == ""
