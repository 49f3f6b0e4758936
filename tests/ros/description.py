# SPDX-License-Identifier: Apache-2.0
"""Descriptions of targets, for tests of the tools that read them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

PICO = {"manufacturer": "Raspberry Pi", "product": "Pico", "serial_digits": 16, "vendor_id": 0x2E8A}
"""The USB device of a Pico."""


def topic(name: str, type: str = "std_msgs/msg/Float64", **more: Any) -> dict[str, Any]:
    return {
        "topic": name,
        "type": type,
        "qos": "reliable",
        "role": "values",
        "values": [name],
        "elements": ["value"],
        **more,
    }


def write_description(
    file: Path,
    *,
    middleware: str = "xrce",
    transport: str | None = "usb",
    node: str = "JIWY_node",
    namespace: str = "",
    usb: dict[str, object] | None = None,
    target: dict[str, str] | None = None,
    subscriptions: Sequence[dict[str, Any]] = (topic("pan_subscriber"),),
    publications: Sequence[dict[str, Any]] = (topic("pan_publisher"),),
) -> Path:
    """A description in EPG's format, with the entries that the tools read."""
    data = {
        "name": file.stem,
        "target": target or {"board": "rpi_pico2", "platform": "freertos"},
        "node": node,
        "namespace": namespace,
        "communication": {
            "middleware": middleware,
            "agent": "micro_ros_agent" if middleware == "xrce" else "",
            "transport": transport,
            "period": 0.033,
            **({"usb": {**PICO, **(usb or {})}} if transport == "usb" else {}),
        },
        "subscriptions": list(subscriptions),
        "publications": list(publications),
    }
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(data), encoding="utf-8")
    return file
