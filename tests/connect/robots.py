# SPDX-License-Identifier: Apache-2.0
"""Projects of robots that no file of EPG describes: a model written by hand, and a board."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from epg.generator.diagnostics import Diagnostics
from epg.new.new_project import ProjectRequest, write_project


def axes_project(folder: Path, axes: Sequence[str], target: str = "rpi_pico2_bare_metal") -> Path:
    """A new project for a controller of ``axes``, each with a setpoint, an encoder, a limit switch and a motor."""
    model = folder / "axes_model"
    model.mkdir()
    inputs = [f"{name}_{axis}" for axis in axes for name in ("position", "setpoint", "end")]
    duties = {f"duty_{axis}": f"setpoint_{axis} - in->position_{axis}" for axis in axes}
    steps = "".join(
        f"    out->{duty} = in->end_{duty[5:]} > 0.5 ? 0.0 : in->{error};\n" for duty, error in duties.items()
    )
    (model / "axes.h").write_text(
        f"typedef struct {{ double {', '.join(inputs)}; }} in_t;\n"
        f"typedef struct {{ double {', '.join(duties)}; }} out_t;\nvoid axes(const in_t *in, out_t *out);\n"
    )
    (model / "axes.c").write_text(f'#include "axes.h"\n\nvoid axes(const in_t *in, out_t *out)\n{{\n{steps}}}\n')
    units = {name: "{}" if name.startswith("end") else "{unit: rad}" for name in inputs}
    (model / "model.yaml").write_text(
        "version: 1\nstep: 1 ms\nheader: axes.h\nsources: [axes.c]\ntypes: {inputs: in_t, outputs: out_t}\n"
        "functions: {step: axes}\ninputs:\n"
        + "".join(f"  {name}: {unit}\n" for name, unit in units.items())
        + "outputs:\n"
        + "".join(f"  {duty}: {{}}\n" for duty in duties)
    )
    write_project(ProjectRequest("robot", folder / "robot", target, model), Diagnostics())
    return folder / "robot"


def jiwy_export_project(folder: Path) -> Path:
    """A new project for JIWY on this computer, with a controller that has the ports of a real export of 20-sim.

    It has no output that resets an encoder.
    """
    model = folder / "export"
    model.mkdir()
    inputs, outputs = ("MeasuredPan", "MeasuredTilt", "SetPointPan", "SetPointTilt"), ("SteeringPan", "SteeringTilt")
    (model / "export.h").write_text(
        f"typedef struct {{ double {', '.join(inputs)}; }} in_t;\n"
        f"typedef struct {{ double {', '.join(outputs)}; }} out_t;\nvoid run(const in_t *in, out_t *out);\n"
    )
    steps = "".join(f"    out->Steering{axis} = in->SetPoint{axis} - in->Measured{axis};\n" for axis in ("Pan", "Tilt"))
    (model / "export.c").write_text(f'#include "export.h"\n\nvoid run(const in_t *in, out_t *out)\n{{\n{steps}}}\n')
    (model / "model.yaml").write_text(
        "version: 1\nstep: 1 ms\nheader: export.h\nsources: [export.c]\ntypes: {inputs: in_t, outputs: out_t}\n"
        "functions: {step: run}\ninputs:\n"
        + "".join(f"  {name}: {{unit: rad}}\n" for name in inputs)
        + "outputs:\n"
        + "".join(f"  {name}: {{}}\n" for name in outputs)
    )
    write_project(ProjectRequest("robot", folder / "robot", "host_jiwy", model), Diagnostics())
    return folder / "robot"


def with_second_target(folder: Path) -> Path:
    """The project ``folder`` with a target ``second``, whose ``.tcf`` extends the first one's."""
    (folder / "second.tcf").write_text("version: 1\nextends: robot.tcf\nnode: second_node\n")
    (folder / "second.bindings.yaml").write_text((folder / "robot.bindings.yaml").read_text())
    cmake = folder / "CMakeLists.txt"
    text = cmake.read_text()
    call = "epg_add_target(second TCF second.tcf MODEL model BINDINGS second.bindings.yaml)"
    cmake.write_text(f"{text}\n{call}\n")
    return folder
