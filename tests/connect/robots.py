# SPDX-License-Identifier: Apache-2.0
"""New projects: of JIWY, and of models that are written by hand."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.new.new_project import ProjectRequest, write_project

ROOT = Path(__file__).resolve().parents[2]


def write_model(folder: Path, name: str, inputs: Mapping[str, str], outputs: Mapping[str, str]) -> Path:
    """A model that is written by hand: the declaration of each input, and the C expression of each output."""
    folder.mkdir()
    (folder / f"{name}.h").write_text(
        f"typedef struct {{ double {', '.join(inputs)}; }} in_t;\n"
        f"typedef struct {{ double {', '.join(outputs)}; }} out_t;\nvoid {name}(const in_t *in, out_t *out);\n"
    )
    steps = "".join(f"    out->{port} = {value};\n" for port, value in outputs.items())
    (folder / f"{name}.c").write_text(
        f'#include "{name}.h"\n\nvoid {name}(const in_t *in, out_t *out)\n{{\n{steps}}}\n'
    )
    (folder / "model.yaml").write_text(
        f"version: 1\nstep: 1 ms\nheader: {name}.h\nsources: [{name}.c]\n"
        f"types: {{inputs: in_t, outputs: out_t}}\nfunctions: {{step: {name}}}\ninputs:\n"
        + "".join(f"  {port}: {unit}\n" for port, unit in inputs.items())
        + "outputs:\n"
        + "".join(f"  {port}: {{}}\n" for port in outputs)
    )
    return folder


def new_project(folder: Path, target: str, model: Path = ROOT / "examples/jiwy/model") -> Path:
    """The project ``robot`` in ``folder``, as ``epg new`` writes it: of JIWY, or of another model."""
    write_project(ProjectRequest("robot", folder, target, model), Diagnostics())
    return folder


def own_axis_project(folder: Path) -> Path:
    """A new project for a controller of an axis of one's own: a setpoint, an encoder, a limit switch and a motor."""
    inputs = {"position_x": "{unit: rad}", "setpoint_x": "{unit: rad}", "end_x": "{}"}
    control = {"duty_x": "in->end_x > 0.5 ? 0.0 : in->setpoint_x - in->position_x"}
    model = write_model(folder / "axis_model", "axis", inputs, control)
    return new_project(folder / "robot", "rpi_pico2_bare_metal", model)


def one_axis_project(folder: Path, target: str) -> Path:
    """A new project of a model with one axis for JIWY, which has two."""
    inputs = dict.fromkeys(("position_pan", "setpoint_pan"), "{unit: rad}")
    model = write_model(folder / "pan", "pan", inputs, {"pwm_pan": "in->setpoint_pan"})
    return new_project(folder / "robot", target, model)


def jiwy_export_project(folder: Path) -> Path:
    """A new project for JIWY on this computer, with a controller that has the ports of a real export of 20-sim.

    It has no output that resets an encoder.
    """
    inputs = dict.fromkeys(("MeasuredPan", "MeasuredTilt", "SetPointPan", "SetPointTilt"), "{unit: rad}")
    outputs = {f"Steering{axis}": f"in->SetPoint{axis} - in->Measured{axis}" for axis in ("Pan", "Tilt")}
    return new_project(folder / "robot", "host_jiwy", write_model(folder / "export", "run", inputs, outputs))


def with_second_target(folder: Path) -> Path:
    """The project ``folder`` with a target ``second``, whose ``.tcf`` extends the first one's."""
    (folder / "second.tcf").write_text("version: 1\nextends: robot.tcf\nnode: second_node\n")
    (folder / "second.bindings.yaml").write_text((folder / "robot.bindings.yaml").read_text())
    cmake = folder / "CMakeLists.txt"
    text = cmake.read_text()
    call = "epg_add_target(second TCF second.tcf MODEL model BINDINGS second.bindings.yaml)"
    cmake.write_text(f"{text}\n{call}\n")
    return folder
