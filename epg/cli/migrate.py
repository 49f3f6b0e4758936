# SPDX-License-Identifier: Apache-2.0
"""``epg migrate``: notes what the files of a target mean now that they did not mean in earlier versions of EPG."""

from __future__ import annotations

import argparse
from fractions import Fraction
from typing import TYPE_CHECKING

from epg.cli.arguments import add_target_arguments, request_of
from epg.generator.diagnostics import Diagnostics

if TYPE_CHECKING:
    from epg.generator.resolve.application import Topic


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_target_arguments(parser, required=True)


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.generator.project import load_application

    application = load_application(request_of(options, "target"), diagnostics)
    for topic in application.subscriptions if application is not None else ():
        component, timeout = topic.component, _timeout_of_speed(topic)
        if component is not None and timeout and "on_timeout" not in component.node:
            after = f"{float(timeout):g} s after its last message"
            message = f"{after}, '{component.name}' becomes 0 now; earlier versions of EPG kept the last value"
            hint = "for the old effect write 'on_timeout: hold': the robot then moves on if the sender stops"
            diagnostics.note("setpoint-default", component.span, message, hint=hint)
    if not diagnostics.has_errors and not any(item.id == "setpoint-default" for item in diagnostics):
        print("the files mean the same as in earlier versions of EPG")
    return 0


def _timeout_of_speed(topic: Topic) -> Fraction | None:
    """The timeout of a setpoint that moves the robot on while no message comes; None if the topic has none."""
    setpoints = [value.setpoint for value in topic.values if value.setpoint is not None]
    return next((each.timeout for each in setpoints if each.fresh and each.timeout and not each.followed), None)
