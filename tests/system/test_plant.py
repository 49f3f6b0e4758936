# SPDX-License-Identifier: Apache-2.0
"""One plant for several targets: each target moves and senses its part of it."""

from __future__ import annotations

import json
import subprocess
from bisect import bisect_left, bisect_right
from pathlib import Path

import pytest

from epg.simulate import simulate_system
from tests.cmake.project import ROOT, Project, copy_jiwy
from tests.system.test_simulation import rows

SPLIT = """version: 1
system: split
plant: {model: plant, bindings: split.plant.yaml}
targets:
  pan: {tcf: rpi_pico_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml}
  tilt: {tcf: rpi_pico_bare_metal_jiwy, model: model, bindings: jiwy.bindings.yaml}
  own:
    tcf: rpi_pico_freertos_jiwy
    model: model
    bindings: jiwy.bindings.yaml
    plant: plant
    plant_bindings: plant.bindings.yaml
world: {sends: [pan/pan_subscriber, tilt/tilt_subscriber, own/pan_subscriber, own/tilt_subscriber,
                pan/tilt_subscriber, tilt/pan_subscriber]}
"""
PAGE = (ROOT / "docs/systems.md").read_text(encoding="utf-8")
SPLIT_PLANT = PAGE.partition("<!-- plant -->\n```yaml\n")[2].partition("```")[0]
ONE = """version: 1
system: one
plant: {model: plant, bindings: one.plant.yaml, period: 100 us}
targets: {own: {tcf: rpi_pico_freertos_jiwy, model: model, bindings: jiwy.bindings.yaml}}
world: {sends: [own/pan_subscriber, own/tilt_subscriber]}
"""
COUPLED = """version: 1
system: coupled
plant: {model: carts, bindings: coupled.plant.yaml}
targets:
  cart: {tcf: cart.tcf, model: wave, bindings: wave.bindings.yaml, count: 2, clock: {start: 0.3 ms, drift: 200}}
world: {sends: [cart/go]}
"""
COUPLED_PLANT = """version: 1
model: carts
inputs: {force_1: {from: cart_1/motor, scale: 4}, force_2: cart_2/motor}
outputs: {position_1: cart_1/encoder, position_2: [cart_2/encoder, cart_1/other], stretch: unconnected}
parameters: {damping: 0.5}
"""
CART = """version: 1
target: rpi_pico_bare_metal
node: cart
control: {enable_at_start: true}
communication: {middleware: xrce}
components:
  motor: {kind: pwm_h_bridge, pins: {value: 2, direction_a: 7, direction_b: 8}, frequency: 20 kHz, dead_time: 0 s}
  encoder: {kind: quadrature_encoder, pins: {a: 10, b: 11}, counts_per_revolution: 65536}
  other: {kind: quadrature_encoder, pins: {a: 12, b: 13}, counts_per_revolution: 65536}
  go: {kind: ros_subscriber}
"""
LISTS = """cmake_minimum_required(VERSION 3.22)
project(robots LANGUAGES C CXX)
find_package(EPG REQUIRED)
foreach(system split one coupled)
  epg_add_system(${system} SYSTEM ${system}.system.yaml)
endforeach()
"""
FILES = {
    "split.system.yaml": SPLIT,
    "split.plant.yaml": SPLIT_PLANT,
    "one.system.yaml": ONE,
    "one.plant.yaml": SPLIT_PLANT.replace("pan/", "own/").replace("tilt/", "own/"),
    "coupled.system.yaml": COUPLED,
    "coupled.plant.yaml": COUPLED_PLANT,
    "cart.tcf": CART,
    "CMakeLists.txt": LISTS,
    "wave.bindings.yaml": """version: 1
model: wave
inputs: {position: encoder, go: go}
outputs: {duty: motor}
""",
    # A duty that depends on the time alone, so that only the plant differs between runs.
    "wave/model.yaml": """version: 1
step: 1 ms
header: wave.h
sources: [wave.c]
instance: wave_t
types: {inputs: wave_inputs_t, outputs: wave_outputs_t}
functions: {step: wave_step}
inputs: {position: {unit: rad}, go: {}}
outputs: {duty: {}}
""",
    "wave/wave.h": """#include <stdint.h>
typedef struct { uint32_t steps; } wave_t;
typedef struct { double position, go; } wave_inputs_t;
typedef struct { double duty; } wave_outputs_t;
void wave_step(wave_t *wave, const wave_inputs_t *inputs, wave_outputs_t *outputs);
""",
    "wave/wave.c": """#include "wave.h"
#include <math.h>
void wave_step(wave_t *wave, const wave_inputs_t *inputs, wave_outputs_t *outputs)
{
    (void)inputs;
    outputs->duty = 0.5 + 0.4 * sin(0.02 * wave->steps++);
}
""",
    # Two carts of 1 kg, a spring and a damper between them, and a weaker spring from each to the ground.
    "carts/model.yaml": """version: 1
name: carts
step: 0.5 ms
header: carts.h
sources: [carts.c]
types: {inputs: carts_inputs_t, outputs: carts_outputs_t}
functions: {init: carts_init, step: carts_step}
inputs: {force_1: {unit: N}, force_2: {unit: N}}
outputs: {position_1: {unit: rad}, position_2: {unit: rad}, stretch: {unit: rad}}
parameters: {damping: {value: 0.2, unit: N s/m, member: carts_damping}}
""",
    "carts/carts.h": """typedef struct { double force_1, force_2; } carts_inputs_t;
typedef struct { double position_1, position_2, stretch; } carts_outputs_t;
extern double carts_damping;
void carts_init(const carts_inputs_t *inputs, carts_outputs_t *outputs);
void carts_step(const carts_inputs_t *inputs, carts_outputs_t *outputs);
""",
    # The method of Heun has order 2.
    "carts/carts.c": """#include "carts.h"
double carts_damping;
static double state[4];

static void rates(const carts_inputs_t *inputs, const double *x, double *dx)
{
    const double between = 400.0 * (x[2] - x[0]) + carts_damping * (x[3] - x[1]);
    dx[0] = x[1];
    dx[1] = inputs->force_1 + between - 50.0 * x[0];
    dx[2] = x[3];
    dx[3] = inputs->force_2 - between - 50.0 * x[2];
}

static void give(carts_outputs_t *outputs)
{
    outputs->position_1 = state[0];
    outputs->position_2 = state[2];
    outputs->stretch = state[2] - state[0];
}

void carts_init(const carts_inputs_t *inputs, carts_outputs_t *outputs)
{
    (void)inputs;
    for (int i = 0; i < 4; i++) {
        state[i] = 0.0;
    }
    give(outputs);
}

void carts_step(const carts_inputs_t *inputs, carts_outputs_t *outputs)
{
    const double h = 0.0005;
    double first[4], second[4], moved[4];
    rates(inputs, state, first);
    for (int i = 0; i < 4; i++) {
        moved[i] = state[i] + h * first[i];
    }
    rates(inputs, moved, second);
    for (int i = 0; i < 4; i++) {
        state[i] += h / 2.0 * (first[i] + second[i]);
    }
    give(outputs);
}
""",
}


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Project:
    project = Project(tmp_path_factory.mktemp("plant"), "robots")
    copy_jiwy(project.source, "model", "plant")
    for name, text in FILES.items():
        path = project.source / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    project.configure()
    project.build()
    return project


SETPOINTS = """time,topic,value
0,$enable,1
5,/{system}/{target}/pan_subscriber,0.4
6,/{system}/{target}/tilt_subscriber,0.2
"""


def run(
    project: Project, system: str, folder: Path, seconds: float, *options: str, moved: tuple[str, ...] = ()
) -> Path:
    """The folder with the traces of a run, in which the targets ``moved`` get setpoints."""
    folder.mkdir()
    command: list[str | Path] = [project.build_folder / system, "--duration", str(seconds), "--trace", folder, *options]
    for target in moved:
        setpoints = folder / f"{target}.in"
        setpoints.write_text(SETPOINTS.format(system=system, target=target))
        command += ["--setpoints", f"{target}={setpoints}"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return folder


def columns(file: Path, *names: str) -> list[list[float]]:
    found = rows(file)
    return [[float(row[name]) for row in found] for name in names]


@pytest.fixture(scope="module")
def split(built: Project, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return run(built, "split", tmp_path_factory.mktemp("split") / "run", 7, moved=("pan", "tilt", "own"))


def test_one_target_does_what_it_does_with_its_own_plant(built: Project, split: Path, tmp_path: Path) -> None:
    one = run(built, "one", tmp_path / "one", 7, moved=("own",))
    assert (one / "own.csv").read_bytes() == (split / "own.csv").read_bytes()


def test_two_targets_share_a_robot(split: Path) -> None:
    """Each axis moves as it does if one target has both: the axes of this robot do not act on each other."""
    for axis in ("pan", "tilt"):
        names = [f"inputs.position_{axis}", f"outputs.pwm_{axis}", f"plant.outputs.angle_{axis}"]
        assert columns(split / f"{axis}.csv", *names) == columns(split / "own.csv", *names)
    assert "plant.outputs.angle_tilt" not in rows(split / "pan.csv")[0]
    angles = columns(split / "own.csv", "inputs.position_pan", "inputs.position_tilt")
    assert abs(angles[0][-1] - 0.4) < 0.02 and max(angles[1]) - min(angles[1]) > 0.1, "the robot has moved"


@pytest.fixture(scope="module")
def coupled(built: Project, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("coupled")
    (folder / "events.csv").write_text("time,target,event\n2.0002,cart_1,die\n3,cart_1,restart\n")
    files = ["--events", str(folder / "events.csv"), "--statistics", str(folder / "run/end.json")]
    return run(built, "coupled", folder / "run", 4, *files)


def test_a_cycle_reads_the_newest_outputs_and_writes_for_the_next_step(coupled: Path) -> None:
    times, force, position = columns(coupled / "plant.csv", "time", "inputs.force_1", "outputs.position_2")
    assert times == [number * 500_000 / 1e9 for number in range(8000)]
    for name in ("cart_1", "cart_2"):
        ticks, seen = columns(coupled / f"{name}.csv", "time", "plant.outputs.position_2")
        assert len(ticks) > 2990
        assert seen == [position[bisect_right(times, tick) - 1] for tick in ticks]
    ticks, written = columns(coupled / "cart_1.csv", "time", "plant.inputs.force_1")
    held = [written[bisect_left(ticks, time) - 1] for time in times]
    alive = [number for number, time in enumerate(times) if number > 0 and not 2.0002 < time <= 3]
    assert [force[number] for number in alive] == [held[number] for number in alive]
    assert max(force) > 3.5, "the binding scales the duty"


def test_the_plant_goes_on_when_a_target_dies(coupled: Path) -> None:
    times, force, position = columns(coupled / "plant.csv", "time", "inputs.force_1", "outputs.position_1")
    dead = [number for number, time in enumerate(times) if 2.0002 < time <= 3]
    assert all(force[number] == 0 for number in dead) and force[dead[0] - 1] > 0 and force[dead[-1] + 1] > 0
    assert len({position[number] for number in dead}) == len(dead)


SCENARIO = """version: 1
duration: 4 s
events:
  - {at: 2.0002 s, target: cart_1, failure: die}
  - {at: 3 s, target: cart_1, failure: restart}
axes:
  carts:
    setpoint: plant.outputs.position_1
    position: plant.outputs.position_2
    unit: m
    windows: [{from: 2.1 s, until: 2.9 s, largest: 10 m}]
"""


def test_a_scenario_judges_the_plant(built: Project, coupled: Path, tmp_path: Path) -> None:
    """The plant has values also while a target is dead."""
    (tmp_path / "carts.yaml").write_text(SCENARIO)
    result = simulate_system(built.build_folder / "coupled", tmp_path / "carts.yaml", tmp_path / "out")
    assert result.passed
    assert (tmp_path / "out/traces/plant.csv").read_bytes() == (coupled / "plant.csv").read_bytes()
    times, one, two = columns(coupled / "plant.csv", "time", "outputs.position_1", "outputs.position_2")
    inside = [number for number, time in enumerate(times) if 2.1 <= time <= 2.9]
    assert result.windows[0].largest == max(abs(two[number] - one[number]) for number in inside) > 0


def test_the_statistics_have_the_last_outputs(coupled: Path) -> None:
    last = rows(coupled / "plant.csv")[-1]
    plant = json.loads((coupled / "end.json").read_text(encoding="utf-8"))["plant"]
    assert plant == {name: float(last[f"outputs.{name}"]) for name in ("position_1", "position_2", "stretch")}


def differences(one: Path, other: Path) -> float:
    """The largest difference of the positions at the ticks of a target."""
    names = ("plant.outputs.position_1",)
    pairs = zip(*columns(one / "cart_1.csv", *names), *columns(other / "cart_1.csv", *names), strict=True)
    return max(abs(a - b) for a, b in pairs)


def test_the_error_of_a_step_has_the_order_of_the_method(built: Project, tmp_path: Path) -> None:
    """The carts are integrated by the method of Heun, of order 2: half of the step makes a quarter of the error.

    All ticks are at steps of the plant: between two steps, a write would act later, which is an error of order 1.
    """
    built.edit("coupled.system.yaml", "clock: {start: 0.3 ms, drift: 200}", "clock: {}")
    steps = (("0.5 ms", "0.0005"), ("0.25 ms", "0.00025"), ("0.125 ms", "0.000125"))
    traces = []
    for (name, seconds), (next_name, next_seconds) in zip(steps, (*steps[1:], steps[0])):
        built.build()
        traces.append(run(built, "coupled", tmp_path / seconds, 3))
        built.edit("carts/model.yaml", name, next_name)
        built.edit("carts/carts.c", seconds, next_seconds)
    built.edit("coupled.system.yaml", "clock: {}", "clock: {start: 0.3 ms, drift: 200}")
    coarse, fine = differences(traces[0], traces[1]), differences(traces[1], traces[2])
    assert 0 < coarse < 1e-4
    assert 3.9 < coarse / fine < 4.1


def test_the_file_sets_the_step_of_the_plant(built: Project, split: Path, tmp_path: Path) -> None:
    """The step need not be a whole number of nanoseconds, and no errors of its time add up."""
    built.edit("one.system.yaml", "100 us", "33.3333 us")
    built.build()
    one = run(built, "one", tmp_path / "one", 7, moved=("own",))
    built.edit("one.system.yaml", "33.3333 us", "100 us")
    (times,) = columns(one / "plant.csv", "time")
    assert times == [-(-number * 333_333 // 10) / 1e9 for number in range(len(times))]
    assert 7 - 1e-4 < times[-1] < 7
    positions = ("plant.outputs.angle_pan", "plant.outputs.angle_tilt")
    for before, after in zip(columns(split / "own.csv", *positions), columns(one / "own.csv", *positions)):
        assert 0 < max(abs(a - b) for a, b in zip(before, after)) < 1e-3


def test_a_plant_that_diverges_ends_the_run(built: Project, tmp_path: Path) -> None:
    """Negative friction lets the plant of a system diverge, and the plant of one target."""
    friction = "\nparameters: {Pan.Motor.d: -1}"
    built.edit("coupled.plant.yaml", "damping: 0.5", "damping: -5000")
    built.edit("plant.bindings.yaml", "  angle_tilt: encoder_tilt", f"  angle_tilt: encoder_tilt{friction}")
    built.build()
    enable = tmp_path / "enable.in"
    enable.write_text("time,topic,value\n0,$enable,1\n")
    for system, output, file, options in (
        ("coupled", "plant/outputs.position_1", "plant.csv", ()),
        ("split", "own/plant.outputs.angle_pan", "own.csv", ("--setpoints", f"own={enable}")),
    ):
        command: list[str | Path] = [built.build_folder / system, "--duration", "10", "--trace", tmp_path, *options]
        done = subprocess.run(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, check=False)
        assert done.returncode == 1
        assert done.stderr.startswith(f"error: the plant has diverged: {output} is ")
        last = float(done.stderr.partition(" at ")[2].partition(" s\n")[0])
        assert last < 5 and last - 0.0011 < float(rows(tmp_path / file)[-1]["time"]) <= last
    built.edit("coupled.plant.yaml", "damping: -5000", "damping: 0.5")
    built.edit("plant.bindings.yaml", friction, "")
