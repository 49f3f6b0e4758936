# SPDX-License-Identifier: Apache-2.0
"""``epg describe``: writes a target's topics in the form of other programs."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from epg.cli.ros_target import add_robot_arguments, robot_of, write_files
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_robot_arguments(parser)
    parser.add_argument("--plotjuggler", action="store_true", help="write <name>.plotjuggler.xml, a layout")
    parser.add_argument("--foxglove", action="store_true", help="write <name>.foxglove.json, a layout")
    parser.add_argument(
        "--ros2-control", action="store_true", help="write <name>.ros2_control.xacro, its controllers and a launch file"
    )
    parser.add_argument(
        "--output", type=Path, default=Path(), metavar="FOLDER", help="folder to write; default: the current folder"
    )
    parser.add_argument("--force", action="store_true", help="overwrite existing files")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.report import to_json
    from epg.ros.foxglove import foxglove_layout
    from epg.ros.plotjuggler import plotjuggler_layout
    from epg.ros.plots import plots_of
    from epg.ros.ros2_control import control_launch_file, controllers_file, hardware_of, xacro_file
    from epg.runs.robot import DamagedDescription, report_damaged

    if not (options.plotjuggler or options.foxglove or options.ros2_control):
        sys.stderr.write("epg describe: add --plotjuggler, --foxglove or --ros2-control\n")
        return 2
    robot = robot_of(options, diagnostics)
    diagnostics.stop_if_errors()
    assert robot is not None
    try:
        plots = plots_of(robot)
    except DamagedDescription as problem:
        report_damaged(Span(str(robot.file)), str(problem), diagnostics)
        return 1
    files = {}
    if options.plotjuggler:
        files[f"{robot.name}.plotjuggler.xml"] = plotjuggler_layout(robot.name, plots)
    if options.foxglove:
        files[f"{robot.name}.foxglove.json"] = foxglove_layout(plots)
    if options.ros2_control and (hardware := hardware_of(robot, diagnostics)) is not None:
        files[f"{robot.name}.ros2_control.xacro"] = xacro_file(hardware)
        files[f"{robot.name}.controllers.yaml"] = controllers_file(hardware)
        files[f"{robot.name}.ros2_control.launch.py"] = control_launch_file(hardware)
    diagnostics.stop_if_errors()
    write_files(options.output, files, options.force, diagnostics)
    if options.json:
        data = [{"title": plot.title, "values": [series.label for series in plot.series]} for plot in plots]
        sys.stdout.write(to_json({"plots": data, "files": list(files)}))
    else:
        print("wrote " + ", ".join(str(options.output / name) for name in files))
    return 0
