# SPDX-License-Identifier: Apache-2.0
"""RELbot's C++ models in closed loop without EPG: the cycle takes 1 ms, the controller runs every second cycle."""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
from pathlib import Path

import pytest
from write_models import EXAMPLES

RELBOT = EXAMPLES / "relbot"
COUNTS_PER_RADIAN = 4096 * 5625 / 361 / (2 * math.pi)

_UNIT = """#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "{name}.cpp"
#include "common/xxinteg.cpp"
#include "common/xxfuncs.cpp"
static {name} self;
extern "C" void initialize(double *u, double *y) {{ self.Initialize(u, y, 0.0); self.SetFinishTime(0.0); }}
extern "C" void calculate(double *u, double *y) {{ self.Calculate(u, y); }}
"""


def library(folder: Path, build: Path) -> ctypes.CDLL:
    compiler = shutil.which("g++") or shutil.which("c++")
    assert compiler is not None, "a C++ compiler is needed"
    (name,) = (path.stem for path in folder.glob("*.cpp"))
    unit = build / f"{folder.name}.cpp"
    unit.write_text(_UNIT.format(name=name), encoding="utf-8")
    output = build / f"{folder.name}.so"
    flags = ["-std=c++17", "-O1", "-ffp-contract=off", "-fPIC", "-shared", "-Wl,-Bsymbolic", f"-I{folder}"]
    subprocess.run([compiler, *flags, str(unit), "-o", str(output)], check=True)
    return ctypes.CDLL(str(output))


def profile(time: float) -> float:
    """Moves from 0 to 2 pi between 1 s and 4 s."""
    phase = min(max((time - 1) / 3, 0.0), 1.0)
    return math.pi * (1 - math.cos(math.pi * phase))


def test_wheels_follow(tmp_path: Path) -> None:
    control, plant = library(RELBOT / "model", tmp_path), library(RELBOT / "plant", tmp_path)
    measured, steer = (ctypes.c_double * 4)(), (ctypes.c_double * 4)()
    drive, outputs = (ctypes.c_double * 2)(), (ctypes.c_double * 5)()
    control.initialize(measured, steer)
    plant.initialize(drive, outputs)
    sent = 0.0
    errors: list[float] = []
    for cycle in range(7000):
        time = cycle / 1000
        if cycle % 33 == 0:
            sent = profile(time)
        if cycle % 2 == 0:
            counts = [math.floor(angle * COUNTS_PER_RADIAN) / COUNTS_PER_RADIAN for angle in outputs[:2]]
            measured[:] = [*counts, sent, -sent / 2]
            control.calculate(measured, steer)
            assert list(steer[:2]) == counts, "logged positions"
            assert all(abs(value) <= 1.0 for value in steer[2:])
        drive[:] = [round(value * 6250) / 6250 for value in steer[2:]]
        for _ in range(10):
            plant.calculate(drive, outputs)
        errors.append(outputs[0] - profile(time + 0.001))
    left, right, heading, _x, _y = outputs
    assert math.sqrt(sum(error * error for error in errors[1000:4000]) / 3000) < 0.1
    assert left == pytest.approx(2 * math.pi, abs=0.03)
    assert right == pytest.approx(-math.pi, abs=0.03)
    assert heading == pytest.approx(0.0505 * (right - left) / 0.208), "the body turns as its wheels do"
