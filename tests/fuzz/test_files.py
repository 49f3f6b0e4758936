# SPDX-License-Identifier: Apache-2.0
"""For any contents of a file, EPG makes code that compiles, or reports errors with a position (see project.py).

The files are made in three ways: arbitrary bytes, mutations of correct files, and robots that are correct by
construction, unchanged and mutated.
"""

from __future__ import annotations

from collections import Counter
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.doubles.twenty_sim.exports import Export
from tests.fuzz.compiler import ROOT, compile_outputs, needs_compiler
from tests.fuzz.long_run import PROFILE, examples
from tests.fuzz.mutation import TEXT_MUTATIONS, YAML_MUTATIONS, mutated
from tests.fuzz.project import Project, project_files
from tests.fuzz.robots import ARGUMENTS, Robot, names, robots

WITH_PLANT = (*ARGUMENTS, "--plant", "plant", "--plant-bindings", "plant.bindings.yaml")
MODEL_ALONE = ("--model", "model")


@cache
def all_kinds() -> dict[str, bytes]:
    """A project on the host with every component kind and a plant."""
    files = project_files(ROOT / "tests/cmake/projects/all_kinds")
    return {name: data for name, data in files.items() if name != "CMakeLists.txt"}


def yaml_files() -> list[str]:
    return sorted(name for name in all_kinds() if name.endswith((".yaml", ".tcf")))


@settings(PROFILE, max_examples=examples(45))
@given(
    st.sampled_from([*yaml_files(), "model/copy.h", "model/copy.c"]),
    st.one_of(st.binary(max_size=200), st.text(max_size=100).map(lambda text: text.encode("utf-8", "surrogatepass"))),
)
def test_arbitrary_bytes(tmp_path: Path, file: str, data: bytes) -> None:
    outcome = Project(tmp_path / "p", all_kinds() | {file: data}, WITH_PLANT).generate()
    assert not outcome.good or not file.endswith((".yaml", ".tcf"))


@needs_compiler
def test_mutated_files_of_a_project(tmp_path: Path) -> None:
    """At least a fifth of the mutated projects compile: the mutations reach the code behind the checks."""
    counts: Counter[str] = Counter()

    @settings(PROFILE, max_examples=examples(140))
    @given(st.data())
    def run(data: st.DataObject) -> None:
        files = all_kinds()
        name = data.draw(st.sampled_from(yaml_files()))
        most = data.draw(st.sampled_from((1, 1, 1, 3)))
        changed = data.draw(mutated(files[name].decode(), YAML_MUTATIONS, most))
        outcome = Project(tmp_path / "p", files | {name: changed}, WITH_PLANT).generate()
        counts["all"] += 1
        counts["same"] += changed == files[name]
        if outcome.good:
            counts["good"] += 1
            _compile_if_new(outcome.files, "robot")

    seen.clear()
    run()
    assert counts["good"] - counts["same"] >= counts["all"] / 5, counts


seen: set[int] = set()


def _compile_if_new(files: Any, name: str) -> None:
    """Compiles only code that was not compiled before, because many mutations give the same code."""
    texts = hash(tuple((file, text) for file, text in sorted(files.items()) if file.endswith((".c", ".h"))))
    if texts not in seen:
        seen.add(texts)
        compile_outputs(name, files)


@needs_compiler
@settings(PROFILE, max_examples=examples(35))
@given(robots(), st.one_of(st.just("robot"), names.filter(lambda name: name not in NO_TARGETS)))
def test_robots_that_are_right_compile(tmp_path: Path, robot: Robot, name: str) -> None:
    outcome = Project(tmp_path / "p", robot.files, ARGUMENTS, name).generate()
    assert outcome.good, outcome.messages
    compile_outputs(name, outcome.files)


NO_TARGETS = ("read", "write", "safe", "pwm", "constant")
"""Legal names of components that no target can have, or that only some components can have."""


@settings(PROFILE, max_examples=examples(45))
@given(robots(), st.data())
def test_mutated_robots(tmp_path: Path, robot: Robot, data: st.DataObject) -> None:
    name = data.draw(st.sampled_from(sorted(robot.files)))
    mutations = YAML_MUTATIONS if name.endswith((".yaml", ".tcf")) else TEXT_MUTATIONS
    changed = data.draw(mutated(robot.files[name].decode(), mutations))
    outcome = Project(tmp_path / "p", robot.files | {name: changed}, ARGUMENTS).generate()
    if outcome.good and data.draw(st.integers(0, 3)) == 0:
        compile_outputs("robot", outcome.files)


@cache
def export(kind: str) -> dict[str, bytes]:
    """The same small controller in each form of an export."""
    import tempfile

    with tempfile.TemporaryDirectory() as made:
        folder = Path(made) / "model"
        if kind == "fmu":
            Export().write_fmu(folder, True, "modelDescription.xml")
        elif kind == "configured":
            Export().write_fmu(folder, False, "ModelConfiguration.xml")
        elif kind == "whole fmu":
            Export(method="RungeKutta4").write_whole_fmu(folder, "output time")
        else:
            getattr(Export(), kind)(folder)
        return project_files(folder, "model")


KINDS = ("write", "write_cpp", "write_tokens", "fmu", "configured", "whole fmu")


@needs_compiler
@pytest.mark.parametrize("kind", KINDS)
def test_mutated_exports(tmp_path: Path, kind: str) -> None:
    """Sources and metadata of a model: the generated interface compiles.  The model's own code is not checked."""
    files = export(kind)
    arguments = ("--model", "model/sources" if kind in ("fmu", "configured") else "model")
    counts: Counter[bool] = Counter()

    @settings(PROFILE, max_examples=examples(50))
    @given(st.data())
    def run(data: st.DataObject) -> None:
        name = data.draw(st.sampled_from(sorted(files)))
        changed = data.draw(mutated(files[name].decode(), TEXT_MUTATIONS, 2))
        outcome = Project(tmp_path / "p", files | {name: changed}, arguments).generate()
        counts[outcome.good] += 1
        if outcome.good:
            _compile_if_new({file: text for file, text in outcome.files.items() if "_export.c" not in file}, "robot")

    assert Project(tmp_path / "p", files, arguments).generate().good
    run()
    assert counts[True] >= sum(counts.values()) / 5, counts


@settings(PROFILE, max_examples=examples(40))
@given(st.sampled_from(KINDS), st.data(), st.binary(max_size=300))
def test_arbitrary_bytes_in_exports(tmp_path: Path, kind: str, data: st.DataObject, junk: bytes) -> None:
    files = export(kind)
    Project(tmp_path / "p", files | {data.draw(st.sampled_from(sorted(files))): junk}, MODEL_ALONE).generate()


@cache
def cubemx_project() -> dict[str, bytes]:
    """A program of STM32CubeMX with a controller."""
    files = project_files(ROOT / "examples/existing_cubemx_repository")
    return {name: data for name, data in files.items() if name.startswith("controller/") or name == "station.ioc"}


CUBEMX = (
    *("--tcf", "controller/turntable.tcf", "--model", "controller/model", "--ioc", "station.ioc"),
    *("--bindings", "controller/turntable.bindings.yaml"),
)
"""Arguments of ``epg generate``."""


def test_mutated_projects_of_cubemx(tmp_path: Path) -> None:
    """Both outcomes are frequent: most keys do not concern EPG, and many that do are in the way."""
    counts: Counter[bool] = Counter()

    @settings(PROFILE, max_examples=examples(60))
    @given(st.data())
    def run(data: st.DataObject) -> None:
        files = cubemx_project()
        text = files["station.ioc"].decode()
        if data.draw(st.booleans()):
            key = data.draw(
                st.sampled_from(("PD12.Signal", "Mcu.IP5", "Mcu.IP77", "PB0.Signal", "VP_SYS_VS_tim6.Signal"))
            )
            value = data.draw(
                st.sampled_from(("TIM4", "TIM7", "S_TIM4_CH1", "GPIO_Output", "SYS_VS_tim7", "USART2", ""))
            )
            text += f"{key}={value}\n"
        else:
            text = data.draw(mutated(text, TEXT_MUTATIONS, 2)).decode("latin-1")
        outcome = Project(tmp_path / "p", files | {"station.ioc": text.encode("latin-1")}, CUBEMX).generate()
        counts[outcome.good] += 1

    assert Project(tmp_path / "p", cubemx_project(), CUBEMX).generate().good
    run()
    assert min(counts[True], counts[False]) >= sum(counts.values()) / 10, counts
