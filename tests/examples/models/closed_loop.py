# SPDX-License-Identifier: Apache-2.0
"""A closed loop of an example's C models without EPG, to test the models themselves.

Encoders count whole steps, are zero at the start, and read zero in the cycle after a reset.  PWM has 6250 steps,
setpoints come every 33 ms, and the cycle takes 1 ms.  The export's own functions are called, in shared libraries.
"""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

CYCLE = 0.001
PLANT_STEPS = 10
PWM_STEPS = 6250
INTERVAL = 0.033
COUNTS_PER_RADIAN = {"pan": 1112 / math.pi, "tilt": 221 / (math.pi / 2)}
AXES = ("pan", "tilt")


class Export:
    """A C export in its own library, because two exports have the same symbols."""

    def __init__(self, folder: Path, build: Path, inputs: int, outputs: int, parameters: Mapping[str, float]) -> None:
        library = build / f"{folder.name}.so"
        if not library.exists():
            sources = sorted(str(path) for path in folder.glob("*.c"))
            flags = ["-std=c11", "-O1", "-ffp-contract=off", "-fPIC", "-shared", "-Wl,-Bsymbolic"]
            compiler = shutil.which("gcc") or shutil.which("cc")
            assert compiler is not None, "a C compiler is needed"
            subprocess.run([compiler, *flags, *sources, "-o", str(library), "-lm"], check=True)
        self._code = ctypes.CDLL(str(library))
        self._u = (ctypes.c_double * inputs)()
        self._y = (ctypes.c_double * outputs)()
        self._folder = folder
        self.initialize(parameters)

    def initialize(self, parameters: Mapping[str, float]) -> None:
        """Starts again; ``parameters`` (by name in 20-sim) replace exported values before the first calculation."""
        for name in ("XXInitializeSubmodel", "XXCalculateSubmodel"):
            getattr(self._code, name).argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_double]
        self._code.XXInitializeSubmodel(self._u, self._y, 0.0)
        text = (self._folder / "xxmodel.c").read_text(encoding="utf-8")
        for name, value in parameters.items():
            line = next(line for line in text.splitlines() if f"/* {name} {{" in line)
            array = (ctypes.c_double * 64).in_dll(self._code, "xx_P")
            array[int(line.split("[")[1].split("]")[0])] = value
        self._code.XXCalculateStatic()

    def step(self, *inputs: float) -> list[float]:
        self._u[:] = list(inputs)
        self._code.XXCalculateSubmodel(self._u, self._y, 0.0)
        return list(self._y)


@dataclass
class Run:
    """The recorded values, one per cycle; angles are the plant's."""

    time: list[float] = field(default_factory=list)
    setpoint: dict[str, list[float]] = field(default_factory=lambda: {axis: [] for axis in AXES})
    angle: dict[str, list[float]] = field(default_factory=lambda: {axis: [] for axis in AXES})
    duty: dict[str, list[float]] = field(default_factory=lambda: {axis: [] for axis in AXES})
    reset: dict[str, list[float]] = field(default_factory=lambda: {axis: [] for axis in AXES})


def run(
    example: Path,
    build: Path,
    duration: float,
    setpoint: Callable[[str, float], float],
    *,
    control: Mapping[str, float] | None = None,
    plant: Mapping[str, float] | None = None,
    encoder_works: bool = True,
    reset_works: bool = True,
) -> Run:
    """Runs controller and plant for ``duration`` seconds; ``setpoint(axis, time)`` is the profile in rad."""
    controller = Export(example / "model", build, 4, 6, control or {})
    machine = Export(example / "plant", build, 2, 2, plant or {})
    recorded = Run()
    duty = dict.fromkeys(AXES, 0.0)
    before = dict.fromkeys(AXES, 0.0)
    sent = {axis: setpoint(axis, 0.0) for axis in AXES}
    angles = machine.step(0.0, 0.0)
    zero = {axis: math.floor(angle * COUNTS_PER_RADIAN[axis]) for axis, angle in zip(AXES, angles)}
    next_setpoint = 0
    for cycle in range(round(duration / CYCLE)):
        time = cycle * CYCLE
        if time >= next_setpoint * INTERVAL - 1e-9:
            sent = {axis: setpoint(axis, time) for axis in AXES}
            next_setpoint += 1
        counts = {axis: math.floor(angle * COUNTS_PER_RADIAN[axis]) for axis, angle in zip(AXES, angles)}
        if not encoder_works:
            counts = zero
        positions = [(counts[axis] - zero[axis]) / COUNTS_PER_RADIAN[axis] for axis in AXES]
        reset_pan, reset_tilt, _, pwm_pan, pwm_tilt, _ = controller.step(*positions, sent["pan"], sent["tilt"])
        for axis, pwm, reset in zip(AXES, (pwm_pan, pwm_tilt), (reset_pan, reset_tilt)):
            duty[axis] = round(max(-1.0, min(1.0, pwm)) * PWM_STEPS) / PWM_STEPS
            if reset > 0.5 >= before[axis] and reset_works:
                zero[axis] = counts[axis]
            before[axis] = reset
            recorded.reset[axis].append(reset)
            recorded.duty[axis].append(duty[axis])
            recorded.setpoint[axis].append(setpoint(axis, time))
        recorded.time.append(time)
        for axis, angle in zip(AXES, angles):
            recorded.angle[axis].append(angle)
        for _ in range(PLANT_STEPS):
            angles = machine.step(duty["pan"], duty["tilt"])
    return recorded
