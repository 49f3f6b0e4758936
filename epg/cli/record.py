# SPDX-License-Identifier: Apache-2.0
"""``epg record``: records the topics of a target or of a system on ROS 2, as CSV files and MCAP."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import refuse_existing
from epg.cli.progress import StopRequest
from epg.cli.ros_target import TARGET, add_robot_arguments, robot_of, robots_of_system
from epg.cli.system import is_system
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.ros.recorder import Channel, Heard
    from epg.runs.robot import Robot


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_robot_arguments(parser, f"{TARGET}; or a system (*.system.yaml)")
    parser.add_argument(
        "--output", type=Path, default=Path(), metavar="FOLDER", help="folder to write; default: the current folder"
    )
    parser.add_argument(
        "--mcap", action="store_true", help="also write recording.mcap, for Foxglove, PlotJuggler and ros2 bag"
    )
    parser.add_argument("--force", action="store_true", help="overwrite an earlier recording")
    parser.add_argument(
        "--duration", type=_seconds, metavar="SECONDS", help="length of the recording; default: until Ctrl-C"
    )
    parser.add_argument(
        "--domain", type=int, choices=range(233), metavar="N", help="ROS domain; default: ROS_DOMAIN_ID, else 0"
    )
    parser.add_argument(
        "--through",
        choices=("dds", "rclpy"),
        help="way to receive; default: dds if CycloneDDS for Python is installed, else rclpy",
    )


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.report import to_json
    from epg.generator import bootstrap
    from epg.ros.recorder import MCAP, SETPOINTS, TOPICS

    robots = _robots(options, diagnostics)
    files = [options.output / name for name in (SETPOINTS, TOPICS, *([MCAP] if options.mcap else []))]
    refuse_existing(files, options.force, diagnostics)
    domain = _domain(options, robots, diagnostics)
    diagnostics.stop_if_errors()
    channels = _channels(options, robots, diagnostics)
    if options.mcap:
        bootstrap.ensure("mcap")
    heard = _recorded(options, channels, domain)
    for topic in heard:
        if topic.messages == 0 and topic.channel.file == TOPICS:  # setpoints need not be sent during a recording
            message = f"no message was received on {topic.channel.name}: {_reason(topic)}"
            diagnostics.warning("nothing-heard", Span(str(robots[0].file)), message)
    if options.json:
        data = [
            {"topic": h.channel.name, "type": h.channel.topic.type, "messages": h.messages, "rate": h.rate}
            for h in heard
        ]
        sys.stdout.write(to_json({"topics": data, "files": [str(file) for file in files]}))
    else:
        print(_table(heard))
        print("\nwrote " + ", ".join(str(file) for file in files))
    return 0


def _robots(options: argparse.Namespace, diagnostics: Diagnostics) -> list[Robot]:
    """The targets to record; none after an error."""
    if is_system(options.target):
        return robots_of_system(options, diagnostics)
    robot = robot_of(options, diagnostics)
    return [] if robot is None else [robot]


def _channels(options: argparse.Namespace, robots: list[Robot], diagnostics: Diagnostics) -> list[Channel]:
    """The topics to record.  Warns of those whose type EPG does not support."""
    from epg.ros.recorder import channels_of, channels_of_system

    channels, unknown = channels_of_system(robots) if is_system(options.target) else channels_of(robots[0])
    for topic in unknown:
        message = f"'{topic.name}' is not recorded: EPG does not support the type {topic.type}"
        diagnostics.warning("type-not-recorded", Span(str(robots[0].file)), message)
    return channels


def _recorded(options: argparse.Namespace, channels: list[Channel], domain: int) -> list[Heard]:
    """Records the topics until the end, and returns a summary of each."""
    from epg.cli.progress import ProgressLine
    from epg.ros.open_source import open_source
    from epg.ros.recorder import record

    source = open_source(options.through, [channel.subscription for channel in channels], domain)
    progress = ProgressLine(quiet=options.json)
    try:
        with StopRequest() as stop:
            return record(source, channels, options.output, options.duration, stop, progress, options.mcap)
    finally:
        source.close()
        progress.done()


def _domain(options: argparse.Namespace, robots: list[Robot], diagnostics: Diagnostics) -> int:
    """The ROS domain: that of ``--domain``, else that of the targets, else ROS_DOMAIN_ID, else 0."""
    if options.domain is not None:
        return int(options.domain)
    domains = {robot.domain for robot in robots}
    if len(domains) > 1:
        named = ", ".join(sorted("the default" if domain is None else str(domain) for domain in domains))
        message, hint = f"its targets are in several domains: {named}", "choose one of them: --domain N"
        diagnostics.error("domain-mismatch", Span(str(options.target)), message, hint=hint)
    domain = next(iter(domains), None)
    if domain is not None:
        return domain
    environment = os.environ.get("ROS_DOMAIN_ID", "")
    return int(environment) if environment.isdigit() else 0


def _reason(heard: Heard) -> str:
    if heard.publishers < 0:
        return "its publisher is best effort, and the description of the target requires reliable"
    if heard.publishers == 0:
        return "there is no publisher in this domain"
    return "its publisher sent nothing"


def _table(heard: list[Heard]) -> str:
    from epg.cli.table import table

    rows = [
        (h.channel.name, h.channel.topic.type, h.messages, f"{h.rate:.1f} Hz" if h.rate else "", h.channel.file)
        for h in heard
    ]
    return table(("topic", "type", "messages", "rate", "file"), rows)


def _seconds(text: str) -> float:
    value = float(text)
    if not 0.0 < value < 1e9:
        raise argparse.ArgumentTypeError(f"'{text}' is not a duration in seconds")
    return value
