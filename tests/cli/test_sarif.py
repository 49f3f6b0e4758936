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


def closed(*required: str, **properties: object) -> dict[str, Any]:
    """The schema of an object that has no other properties than these."""
    return {"type": "object", "properties": properties, "required": list(required), "additionalProperties": False}


def several(items: object) -> dict[str, Any]:
    return {"type": "array", "minItems": 1, "items": items}


_TEXT = {"type": "string"}
_POSITIVE = {"type": "integer", "minimum": 1}
_INDEX = {"type": "integer", "minimum": 0}
_MESSAGE = {"type": "object", "properties": {"text": {"type": "string", "minLength": 1}}, "required": ["text"]}
_FILE = closed("uri", uri={"type": "string", "pattern": "^[^\\\\ ]+$"})
_REGION = closed(
    "startLine",
    **dict.fromkeys(("startLine", "startColumn", "endLine", "endColumn"), _POSITIVE),
)
_LOCATION = closed(
    id=_INDEX,
    message=_MESSAGE,
    physicalLocation=closed("artifactLocation", artifactLocation=_FILE, region=_REGION),
    logicalLocations=several({}),
)
_REPLACEMENT = closed("deletedRegion", deletedRegion=_REGION, insertedContent=_MESSAGE)
_CHANGE = closed("artifactLocation", "replacements", artifactLocation=_FILE, replacements=several(_REPLACEMENT))
_FIX = closed("artifactChanges", description=_MESSAGE, artifactChanges=several(_CHANGE))
_RULE = closed(
    *("id", "shortDescription", "helpUri"),
    **dict.fromkeys(("id", "helpUri"), _TEXT),
    **dict.fromkeys(("shortDescription", "fullDescription", "help"), _MESSAGE),
)
_DRIVER = closed(
    "name",
    name=_TEXT,
    semanticVersion={"type": "string", "pattern": r"^\d+\.\d+\.\d+"},
    informationUri=_TEXT,
    rules={"type": "array", "items": _RULE},
)
_RESULT = closed(
    *("message", "ruleId", "level", "locations"),
    ruleId=_TEXT,
    ruleIndex=_INDEX,
    level={"enum": ["none", "note", "warning", "error"]},
    message=_MESSAGE,
    locations={"type": "array", "items": _LOCATION},
    relatedLocations={"type": "array", "items": _LOCATION},
    fixes=several(_FIX),
)
_RUN = closed(
    *("tool", "results"),
    tool={"type": "object", "properties": {"driver": _DRIVER}, "required": ["driver"]},
    columnKind={"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
    results={"type": "array", "items": _RESULT},
)
SARIF = closed("version", "runs", **{"$schema": _TEXT}, version={"const": "2.1.0"}, runs=several(_RUN))
"""The requirements of SARIF 2.1.0 (3.13 to 3.30, 3.49, 3.55 to 3.57) on the parts of a log that EPG writes."""


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
    assert result["fixes"] == [
        {
            "description": {"text": "did you mean 'period'?"},
            "artifactChanges": [
                {
                    "artifactLocation": {"uri": "robot.tcf"},
                    "replacements": [
                        {
                            "deletedRegion": {"startLine": 4, "startColumn": 11, "endColumn": 16},
                            "insertedContent": {"text": "period"},
                        }
                    ],
                }
            ],
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


def test_lines_to_insert_are_fixes(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One region of no length; several fixes if the user must choose; a region of several lines."""
    change(robot / "bindings.yaml", "  log: position\n", "")
    bound = "inputs:\n  angle: encoder\n  go: button\n  setpoint: target\n"
    possible = "no name matches; possible: encoder"
    change(
        robot / "bindings.yaml",
        bound,
        f"# inputs:    # remove this '#' with the first below it\n  # angle:    # {possible}\n",
    )
    assert main(["check", "--format=sarif", *FILES]) == 1
    fixes = {result["message"]["text"].split("'")[1]: result.get("fixes", ()) for result in sarif(capsys)["results"]}
    changes = {
        name: [(fix["description"]["text"], *fix["artifactChanges"][0]["replacements"]) for fix in listed]
        for name, listed in fixes.items()
    }
    region = {"startLine": 6, "startColumn": 14, "endColumn": 14}
    assert changes["log"] == [
        (f"write 'log: {end}'", {"deletedRegion": region, "insertedContent": {"text": f"\n  log: {end}"}})
        for end in ("position", "unconnected")
    ]
    region = {"startLine": 3, "startColumn": 1, "endLine": 4, "endColumn": len(f"  # angle:    # {possible}") + 1}
    (changed,) = changes["angle"]
    assert changed[1] == {"deletedRegion": region, "insertedContent": {"text": "inputs:\n  angle: encoder"}}


def test_a_value_of_the_command_line_is_in_no_file(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "--format=sarif", *FILES, "--set", "control.perod=1 ms"]) == 1
    (result,) = sarif(capsys)["results"]
    assert "fixes" not in result, "a fix must change a file"
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


def test_edits_are_in_the_json(robot: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An edit of a file, of a part of a value in quotes, and of an argument; a new line; none without a proposal."""
    change(robot / "robot.tcf", "period: 1 ms", "perid: 1 ms")
    change(robot / "bindings.yaml", "reset: encoder.reset", 'reset: "encoder.rest"')
    assert main(["check", "--format=json", *FILES]) == 1
    edits = {each["id"]: each["edits"] for each in json.loads(capsys.readouterr().out)["diagnostics"]}
    assert edits["unknown-key"] == [{
        "file": "robot.tcf", "line": 4, "column": 11, "end_line": 4, "end": 16, "old": "perid", "new": "period",
        "sentence": "did you mean 'period'?",
    }]  # fmt: skip
    change(robot / "robot.tcf", "perid: 1 ms", "period: 1 ms")
    assert main(["check", "--format=json", *FILES, "--set", "control.perod=1 ms"]) == 1
    (found,) = json.loads(capsys.readouterr().out)["diagnostics"]
    assert found["edits"] == [{
        "file": "command line", "line": 1, "column": 9, "end_line": 1, "end": 14, "old": "perod", "new": "period",
        "sentence": "did you mean 'period'?", "argument": "control.period=1 ms",
    }]  # fmt: skip
    assert main(["check", "--format=json", *FILES]) == 1
    (found,) = json.loads(capsys.readouterr().out)["diagnostics"]
    (edit,) = found["edits"]
    assert edit["new"] == "reset" and edit["column"] == found["column"] + len('"encoder.')
    change(robot / "bindings.yaml", '"encoder.rest"', "motor")
    assert main(["check", "--format=json", *FILES]) == 1
    assert all(each["edits"] == [] for each in json.loads(capsys.readouterr().out)["diagnostics"])
    change(robot / "bindings.yaml", "reset: motor", "reset: encoder.reset")
    change(robot / "bindings.yaml", "  go: button\n", "")
    change(robot / "bindings.yaml", "  setpoint: target\n", "")
    assert main(["check", "--format=json", *FILES]) == 1
    edits = {each["message"]: each["edits"] for each in json.loads(capsys.readouterr().out)["diagnostics"]}
    assert edits["model input 'setpoint' is not bound"] == [{
        "file": "bindings.yaml", "line": 4, "column": 17, "end_line": 4, "end": 17, "old": "",
        "new": "\n  setpoint: target", "sentence": "add 'inputs: {setpoint: target}'",
    }]  # fmt: skip
