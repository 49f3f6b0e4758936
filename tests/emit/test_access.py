# SPDX-License-Identifier: Apache-2.0
"""The functions by which the user's program sets and gets values by name: their names, their comments, their effect."""

from __future__ import annotations

import os
import platform
import re
import shutil
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator.diagnostics import Diagnostics
from epg.generator.emit.access import unique_words
from epg.generator.emit.model.variables import model_variables
from tests.fuzz.compiler import ROOT, compile_outputs, include_options, needs_compiler
from tests.platforms.host.program import ADDRESS_SANITIZER, TARGETS, THREAD_SANITIZER, include_folders, platform_sources
from tests.runtime.program import compile_program, run_program

PROJECT = Path(__file__).resolve().parent / "access"
FILES = ["--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml", "--output", "out"]


@needs_compiler
def test_the_program_of_the_page(tmp_path: Path) -> None:
    page = (ROOT / "docs/own-program.md").read_text(encoding="utf-8")
    (program,) = re.findall(r"```c\n(.*?)```", page, re.S)
    jiwy = ROOT / "examples/jiwy"
    files = ["--model", str(jiwy / "model"), "--bindings", str(jiwy / "jiwy.bindings.yaml")]
    assert main(["generate", "jiwy", "--tcf", "host_jiwy.tcf", *files, "--output", str(tmp_path / "out")]) == 0
    texts = {path.name: path.read_text(encoding="utf-8") for path in (tmp_path / "out").iterdir() if path.is_file()}
    compile_outputs("jiwy", texts | {"program.c": program})


def generate(folder: Path, *options: str, target: str = "robot") -> dict[str, str]:
    """The generated texts by name of file."""
    shutil.copytree(PROJECT, folder, dirs_exist_ok=True)
    before = Path.cwd()
    os.chdir(folder)
    try:
        assert main(["generate", target, *FILES, *options]) == 0
    finally:
        os.chdir(before)
    return {path.name: path.read_text(encoding="utf-8") for path in (folder / "out").iterdir() if path.is_file()}


@pytest.mark.parametrize(
    ("names", "words"),
    [
        ([("a", "input"), ("b", "output"), ("c", "parameter")], ["a", "b", "c"]),
        ([("a", "input"), ("a", "output")], ["a_input", "a_output"]),
        ([("a", "output"), ("a", "parameter"), ("b", "input")], ["a_output", "a_parameter", "b"]),
        ([("a", "input"), ("a", "output"), ("a_input", "output")], ["a_input_2", "a_output", "a_input"]),
        (
            [("a", "input"), ("a", "parameter"), ("a_input", "input"), ("a_input", "output")],
            ["a_input_2", "a_parameter", "a_input_input", "a_input_output"],
        ),
    ],
)
def test_words(names: list[tuple[str, str]], words: list[str]) -> None:
    assert unique_words(names) == words


def test_the_header_declares_a_function_for_each_value(tmp_path: Path) -> None:
    header = generate(tmp_path)["robot.h"]
    assert re.findall(r"^bool robot_((?:set|get)\w*)\(", header, re.M) == [
        *("set_x_input", "set_speed", "set_again"),
        *("get", "get_x_input", "get_speed", "get_again", "get_one"),
        *("get_x_output", "get_twice", "get_steps_output", "get_product"),
        *("set_gain", "get_gain", "set_steps_parameter", "get_steps_parameter"),
    ]
    assert re.search(r"robot_(in|out)puts;", header) is None, "the values belong to the control side"
    comment = header[: header.index("bool robot_set_speed")].rpartition("/**")[2]
    assert " ".join(comment.split()) == (
        "Sets `speed` as a message for components.speed.linear_x does, in m/s. The model's input is the value * "
        "1000.0. A value outside of -2.0 to 2.0 is refused. Only values after the enabling act. "
        "It changes by at most 1e+06 per second. "
        "After 10 s without a new value it becomes 0. */"
    )
    assert "Sets `x` as a message for components.set_x does, in rad.  Sets `again`, too. */" in header
    assert "/** Parameter `gain` in 1/s, 0 to 100. */" in header


def test_debuggers_find_the_values(tmp_path: Path) -> None:
    code = generate(tmp_path)["robot_app.c"]
    assert "\nrobot_model_inputs_t robot_inputs;\nrobot_model_outputs_t robot_outputs;\n" in code


@needs_compiler
@pytest.mark.parametrize("target", ["robot", "get", "set", "value", "parameter", "setpoint", "collect", "own"])
def test_no_name_of_a_target_is_in_conflict(target: str, tmp_path: Path) -> None:
    compile_outputs(target, generate(tmp_path, target=target))


@needs_compiler
@pytest.mark.parametrize("sanitizer", [ADDRESS_SANITIZER, THREAD_SANITIZER], ids=["address", "thread"])
@pytest.mark.parametrize("middleware", ["none", "console"])
def test_a_program_beside_messages_and_cycles(middleware: str, sanitizer: list[str], tmp_path: Path) -> None:
    """Every value arrives, whole and in order, and there is no data race."""
    files = generate(tmp_path, "--set", f"communication.middleware={middleware}")
    folders = [option.removeprefix("-I") for option in include_options(files["robot.cmake"])]
    console = TARGETS / "middlewares" / "console"
    sources = [*sorted((tmp_path / "out").glob("*.c")), *platform_sources(main=False), tmp_path / "main.c"]
    sources += sorted((tmp_path / "model").glob("*.c"))
    no_variables = tmp_path / "no_variables.c"
    no_variables.write_text(model_variables("robot_model", 1, [], Diagnostics())[1], encoding="utf-8")
    sources.append(no_variables)
    program = compile_program(
        tmp_path / "program",
        list(dict.fromkeys([*sources, *(sorted(console.glob("*.c")) if middleware == "console" else [])])),
        options=["-O1", *sanitizer],
        defines=["SHARED"] if middleware == "console" else [],
        includes=[tmp_path / "out", tmp_path / "model", console, *map(Path, folders), *include_folders()],
    )
    environment = {"TSAN_OPTIONS": "halt_on_error=1 exitcode=66"}
    done = run_program([program], environment=environment)
    if "unexpected memory mapping" in done.stderr:
        # This ThreadSanitizer does not support the address-space randomisation of newer kernels.
        done = run_program(["setarch", platform.machine(), "-R", program], environment=environment)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_indices_have_names(tmp_path: Path) -> None:
    files = generate(tmp_path)
    indices = re.findall(r"_target\.control, (\w+)", files["robot_access.c"])
    names = ["SETPOINT_SET_X", "SETPOINT_SPEED", "SETPOINT_SET_X"]
    names += ["MODEL_GAIN", "MODEL_GAIN", "MODEL_STEPS", "MODEL_STEPS"]
    assert indices == [f"ROBOT_{name}" for name in names]
    constants = re.findall(r"ROBOT_COMPONENT_(\w+),", files["robot.h"])
    table = files["robot_app.c"].partition("components[] = {")[2].partition("}")[0]
    assert [name.lower() for name in constants] == re.findall(r'"(\w+)"', table) != []
