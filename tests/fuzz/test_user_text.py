# SPDX-License-Identifier: Apache-2.0
"""A user's text at every place at which it reaches an output: it appears unchanged and has no other effect."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.fuzz.compiler import ROOT, STRICT, compile_outputs, needs_compiler
from tests.fuzz.project import Project, run_epg
from tests.fuzz.test_files import WITH_PLANT, all_kinds

HOSTILE = [
    "*/ #error comment /*",
    "// \\",
    "??/",
    '"; int broken; //',
    "%s%n%d",
    "\\",
    "\n#error line",
    "\r\n",
    "\t",
    "\x07\x1b[31m",
    "\u2028\u202e",
    "${CMAKE_SOURCE_DIR}",
    "$ENV{HOME} $<1:x>",
    "a;b",
    "# comment",
    "[=[ ]=]",
    "@x@",
    "{{ x }}{% y %}{# z #}",
    "&amp; <b> &",
    "' `id` $(id)",
    "é µ 日本 😀",
    "",
]


def in_yaml(text: str) -> str:
    """``text`` in double quotes of YAML."""
    return '"' + "".join(f"\\U{ord(char):08x}" for char in text) + '"'


def replaced(files: dict[str, bytes], name: str, old: str, new: str) -> dict[str, bytes]:
    text = files[name].decode()
    assert old in text, (name, old)
    return files | {name: text.replace(old, new).encode()}


@needs_compiler
@pytest.mark.parametrize("text", HOSTILE, ids=repr)
def test_descriptions_units_and_names_of_a_model(text: str, tmp_path: Path) -> None:
    """The description of a model is only in comments; no part of it is compiled."""
    files = replaced(all_kinds(), "model/model.yaml", "  button: {}", f"  button: {{description: {in_yaml(text)}}}")
    files = replaced(files, "model/model.yaml", "  heat: {}", f"  heat: {{unit: {in_yaml(text)}}}")
    shown = "".join(char if char.isprintable() else "?" for char in text) or "Copy"
    if text:
        files = replaced(files, "model/model.yaml", "name: Copy", f"name: {in_yaml(text)}")
        files = replaced(files, "bindings.yaml", "model: Copy", f"model: {in_yaml(shown)}")
    outcome = Project(tmp_path / "p", files, WITH_PLANT).generate()
    if not outcome.good:  # a name of spaces is not a name
        assert not text.strip() or "[unit-mismatch]" in outcome.messages, outcome.messages
        return
    compile_outputs("robot", outcome.files)
    assert json.loads(outcome.files["robot.json"])["model"]["name"] == shown


@pytest.mark.parametrize("text", ["*/ x", '";x;//', "a\n#error", "${x}", "a;b", "é", "a\\", "{{ x }}"], ids=repr)
@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("robot.tcf", "node: robot", "node: {}"),
        ("robot.tcf", "namespace: /lab", "namespace: {}"),
        ("robot.tcf", "topic: speed", "topic: {}"),
        ("robot.tcf", "enable_topic: enable", "enable_topic: {}"),
        ("robot.tcf", "  offset: {kind", "  {}: {{kind"),
        ("bindings.yaml", "  lamp: lamp", "  lamp: {}"),
        ("model/model.yaml", "step: copy_step", "step: {}"),
        ("model/model.yaml", "inputs: copy_inputs_t", "inputs: {}"),
        ("model/model.yaml", "header: copy.h", "header: {}"),
        ("model/model.yaml", "sources: [copy.c]", "sources: [{}]"),
        ("model/model.yaml", "  button: {}", "  {}: {{}}"),
    ],
    ids=lambda value: value.replace(" ", "") if isinstance(value, str) else None,
)
def test_names_that_reach_code_are_names(file: str, old: str, new: str, text: str, tmp_path: Path) -> None:
    files = replaced(all_kinds(), file, old, new.format(in_yaml(text)))
    outcome = Project(tmp_path / "p", files, WITH_PLANT).generate()
    assert not outcome.good


@needs_compiler
@pytest.mark.parametrize(
    "text", [text for text in HOSTILE if text.strip() and "\n" not in text and "*/" not in text], ids=repr
)
def test_names_of_20sim(text: str, tmp_path: Path) -> None:
    """Ports and parameters of an export may have any name that a comment can contain."""
    from tests.fuzz.test_files import export

    name = text.replace("\r", "").replace("\\", "\\\\") or "x"
    files = dict(export("write"))
    for file in ("model/xxsubmod.c", "model/xxmodel.c"):
        source = files[file].decode()
        source = source.replace("/* position {rad} */", f"/* {name} {{rad}} */").replace(
            "/* PI1\\kp {} */", f"/* {name} */"
        )
        files[file] = source.encode()
    del files["model/tokens.xml"]
    outcome = Project(tmp_path / "p", files, ("--model", "model")).generate()
    if outcome.good:
        compile_outputs("robot", {file: text for file, text in outcome.files.items() if "_export.c" not in file})
        assert outcome.files["robot.h"].count("#error") == 0


FOLDERS = """a b|a'b|a"b|a$b|a${b}|a#b|a;b|a(b)|a[b]|aé日|a\\b|a&b|a%b|a@b@|a\nb|a[b|a]b|a$ENV{b}|a]=]b[[""".split("|")
FOLDERS.append("a|b")


def needs_names(name: str) -> None:
    if os.name == "nt" and re.search(r'["\\:*?<>|\n]', name):
        pytest.skip("Windows has no such names")


@pytest.mark.parametrize("folder", FOLDERS, ids=repr)
def test_folders_of_any_name(folder: str, tmp_path: Path) -> None:
    """CMake finds exactly these files; a name that its lists cannot contain is an error with that reason."""
    needs_names(folder)
    files = {
        name.replace("model/", f"{folder}/", 1) if name.startswith("model/") else name: data
        for name, data in all_kinds().items()
    }
    arguments = tuple(folder if word == "model" else word for word in WITH_PLANT)
    project = Project(tmp_path / "p", files, arguments)
    outcome = project.generate()
    if not outcome.good:
        assert folder in ("a\nb", "a[b", "a]b", "a${b}", "a$ENV{b}", "a]=]b[[", "a|b"), outcome.messages
        return
    script = tmp_path / "show.cmake"
    script.write_text(
        f'set(EPG_TARGETS_DIR "{(ROOT / "targets").as_posix()}")\n'
        f'include("${{CMAKE_SOURCE_DIR}}/output/robot.cmake")\n'
        "foreach(file IN LISTS EPG_robot_model_EXPORTED EPG_DEPENDS EPG_COMPONENT_INCLUDES)\n"
        '  if(NOT EXISTS "${file}")\n    message(FATAL_ERROR "no file ${file}")\n  endif()\nendforeach()\n'
        "list(LENGTH EPG_robot_model_EXPORTED count)\n"
        'if(NOT count EQUAL 1)\n  message(FATAL_ERROR "${count} sources")\nendif()\n',
        encoding="utf-8",
    )
    done = subprocess.run(["cmake", "-P", str(script)], cwd=project.folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    described = json.loads(outcome.files["robot.json"])
    assert described["model"]["folder"] == folder


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have no names that are no text")
def test_folders_whose_name_is_no_text(tmp_path: Path) -> None:
    model = os.fsdecode(b"m\xffodel")
    files = {
        name.replace("model/", f"{model}/", 1) if name.startswith("model/") else name: data
        for name, data in all_kinds().items()
    }
    outcome = Project(
        tmp_path / "q", files, tuple(model if word == "model" else word for word in WITH_PLANT)
    ).generate()
    assert not outcome.good
    assert "UTF-8" in outcome.messages


@needs_compiler
def test_what_is_seen_when_it_runs(tmp_path: Path) -> None:
    """The header of a trace contains the port names exactly as in 20-sim."""
    from tests.doubles.twenty_sim.exports import Export
    from tests.fuzz.test_files import export

    assert Export().inputs[0][0] == "in"
    strange = 'PID1\\a"b %s ${x} é'
    files = {name: data for name, data in export("write").items() if name != "model/tokens.xml"}
    files["model/xxsubmod.c"] = files["model/xxsubmod.c"].replace(
        b"/* in {rad} */", f"/* {strange} {{rad}} */".encode()
    )
    files["robot.tcf"] = (
        b"version: 1\ntarget: host\nnode: robot\ncontrol: {enable_at_start: true}\n"
        b"components:\n  one: {kind: constant, value: 1}\n"
    )
    files["bindings.yaml"] = (
        f"version: 1\nmodel: Servo\ninputs:\n  {in_yaml(strange)}: one\n  position: one\n"
        "outputs: {corr: unconnected, out: unconnected}\n"
    ).encode()
    project = Project(tmp_path / "p", files, ("--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml"))
    outcome = project.generate()
    assert outcome.good, outcome.messages
    (project.folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22)\nproject(p LANGUAGES C)\nfind_package(EPG REQUIRED)\n"
        "epg_add_target(robot TCF robot.tcf MODEL model BINDINGS bindings.yaml)\n"
        "epg_add_executable(program EPG::robot)\n",
        encoding="utf-8",
    )
    build = tmp_path / "build"
    options = [f"-DEPG_DIR={ROOT / 'cmake'}", f"-DCMAKE_C_FLAGS={' '.join(STRICT[1:])}"]
    for command in (
        ["cmake", "-S", str(project.folder), "-B", str(build), *options],
        ["cmake", "--build", str(build), "--target", "program"],
    ):
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
    program = next(path for path in build.rglob("program*") if path.is_file() and os.access(path, os.X_OK))
    trace = tmp_path / "trace.csv"
    done = subprocess.run([str(program), "--duration", "0.01", "--trace", str(trace)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    told = subprocess.run([str(program), "--help"], capture_output=True, text=True)
    assert told.returncode == 0 and "'robot'" in told.stdout
    with trace.open(encoding="utf-8", newline="") as file:
        header = next(csv.reader(file))
    assert f"inputs.{strange}" in header


@pytest.mark.parametrize("name", ['a"b', "a>b", "a<b", "a\\b", "a\nb"], ids=repr)
def test_files_that_cannot_be_included(name: str, tmp_path: Path) -> None:
    """C++ sources and headers are included by name, and C has no escape sequences in such a name."""
    needs_names(name)
    files = all_kinds()
    for suffix, key, old in ((".cpp", "sources", "sources: [copy.c]"), (".h", "header", "header: copy.h")):
        new = f"{key}: [{in_yaml(name + suffix)}]" if key == "sources" else f"{key}: {in_yaml(name + suffix)}"
        changed = replaced(files, "model/model.yaml", old, new)
        changed = replaced(changed, "model/model.yaml", "step: 2 ms", "step: 2 ms\nlanguage: c++")
        changed[f"model/{name}{suffix}"] = files["model/copy" + (".c" if suffix == ".cpp" else ".h")]
        if key == "header":
            changed = replaced(changed, "model/model.yaml", "[copy.c]", "[copy.cpp]") | {
                "model/copy.cpp": files["model/copy.c"]
            }
        outcome = Project(tmp_path / "p", changed, WITH_PLANT).generate()
        assert "[invalid-name]" in outcome.messages
        assert len(outcome.errors) == 1, outcome.messages
    (tmp_path / "export").mkdir()
    from tests.fuzz.test_files import export

    servo = {file.replace("Servo.cpp", f"{name}.cpp"): data for file, data in export("write_cpp").items()}
    outcome = Project(tmp_path / "p", servo, ("--model", "model")).generate()
    assert "[invalid-name]" in outcome.messages


def test_other_commands_show_names_on_one_line(tmp_path: Path) -> None:
    """A name with control characters neither moves the cursor of a terminal nor begins a line of a bindings file."""
    from tests.fuzz.test_files import export

    files = dict(export("write"))
    del files["model/tokens.xml"]
    source = files["model/xxsubmod.c"].replace(b"/* position {rad} */", b"/* posi\x1b[2Jtion \x9b {r\x07d} */")
    files["model/xxsubmod.c"] = source
    files["robot.tcf"] = all_kinds()["robot.tcf"]
    project = Project(tmp_path / "p", files, ("--model", "model"))
    for command in (
        ["ports", "model"],
        ["ports", "model", "--json"],
        ["bind", "model", "robot.tcf"],
    ):
        status, printed, messages = run_epg(command, project.folder, 10)
        assert status == 0, messages
        assert all(char.isprintable() or char == "\n" for char in printed)
        assert "posi?[2Jtion ?" in printed
