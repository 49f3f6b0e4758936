# SPDX-License-Identifier: Apache-2.0
"""Thousands of components, ports, wires and parameters, all right or all wrong: the time is proportional to them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.fuzz.long_run import LONG
from tests.fuzz.project import Outcome, Project
from tests.fuzz.robots import ARGUMENTS

COUNT = 10_000 if LONG else 2_000
SECONDS = COUNT / 20
"""A limit of processor time for runs that do not end."""


def project(count: int) -> dict[str, bytes]:
    """One constant for each input of a model, and the same number of parameters."""
    numbers = range(count)
    components = "".join(f"  c{i}: {{kind: constant, value: {i}}}\n" for i in numbers)
    inputs = "".join(f"  p{i}: {{}}\n" for i in numbers)
    parameters = "".join(f"  q{i}: {i}\n" for i in numbers)
    wires = "".join(f"  p{i}: c{i}\n" for i in numbers)
    members = " ".join(f"double p{i};" for i in numbers)
    variables = "".join(f"double q{i};\n" for i in numbers)
    return {
        "robot.tcf": (
            f"version: 1\ntarget: host\nnode: r\ncontrol: {{enable_at_start: true}}\ncomponents:\n{components}"
            "  out: {kind: ros_publisher, topic: out}\n"
        ).encode(),
        "bindings.yaml": f"version: 1\nmodel: Big\noutputs: {{o: out}}\ninputs:\n{wires}".encode(),
        "model/model.yaml": (
            "version: 1\nname: Big\nstep: 1 ms\nheader: big.h\nsources: [big.c]\nfunctions: {step: s}\n"
            f"types: {{inputs: i_t, outputs: o_t}}\noutputs: {{o: {{}}}}\ninputs:\n{inputs}parameters:\n{parameters}"
        ).encode(),
        "model/big.h": (
            f"typedef struct {{{members}}} i_t;\ntypedef struct {{double o;}} o_t;\nvoid s(const i_t *i, o_t *o);\n"
            + variables.replace("double", "extern double")
        ).encode(),
        "model/big.c": (
            f'#include "big.h"\n{variables}void s(const i_t *i, o_t *o)\n{{\n    (void)i;\n    o->o = 0;\n}}\n'
        ).encode(),
    }


def check_proportional(folder: Path, file: str = "", old: str = "", new: str = "") -> Outcome:
    """Generates from projects of two sizes, in whose ``file`` ``new`` replaces ``old``, and compares their times.

    Four times the size takes at most four times as long, but 16 times if an algorithm is quadratic.  Before and after
    the large project, a small one shows how fast this computer is.
    """

    def run(count: int) -> tuple[float, Outcome]:
        files = project(count)
        if file:
            files[file] = files[file].replace(old.encode(), new.encode())
        made = Project(folder / "p", files, ARGUMENTS)
        began = os.times().user
        outcome = made.generate(SECONDS)
        return os.times().user - began, outcome

    before, _ = run(COUNT // 4)
    took, outcome = run(COUNT)
    after, _ = run(COUNT // 4)
    assert took < 8 * max(before, after), f"{before:.2f} s, {took:.2f} s, {after:.2f} s"
    return outcome


def test_right(tmp_path: Path) -> None:
    outcome = check_proportional(tmp_path)
    assert outcome.good, outcome.errors[:3]


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("bindings.yaml", "  p", "  z"),
        ("bindings.yaml", ": c", ": d"),
        ("bindings.yaml", "inputs:\n", "parameters:\n  r: 1\ninputs:\n"),
        ("bindings.yaml", ": c", ": c.x"),
        ("robot.tcf", "kind: constant", "kind: constants"),
        ("robot.tcf", "value:", "valu:"),
        ("robot.tcf", "value: ", "value: x"),
        ("robot.tcf", "{kind: constant, value", "{kind: ros_subscriber, topic: t, initial"),
        ("model/model.yaml", ": {}", ": {unit: V, typ: real}"),
        ("model/model.yaml", "  q", "  if: 1\n  p"),
        ("model/model.yaml", "  q", "  r"),
        ("model/model.yaml", "  p", "  s"),
    ],
    ids=str,
)
def test_everything_wrong(file: str, old: str, new: str, tmp_path: Path) -> None:
    outcome = check_proportional(tmp_path, file, old, new)
    assert not outcome.good
