# SPDX-License-Identifier: Apache-2.0
"""Writes plots as a layout of Foxglove and Lichtblick.

The applications read it as ``LayoutData``: the panels by id, and a binary tree (a *mosaic*) of their places.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from epg.ros.plots import Plot, Series


def foxglove_layout(plots: Sequence[Plot]) -> str:
    """The text of a layout with the plots in a column."""
    ids = [f"Plot!epg{number}" for number in range(1, len(plots) + 1)]
    data: dict[str, Any] = {
        "configById": {name: _panel(plot) for name, plot in zip(ids, plots)},
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
    }
    if ids:
        data["layout"] = _mosaic(ids)
    return json.dumps(data, indent=2, ensure_ascii=False) + "\n"


def message_path(series: Series) -> str:
    """The message path of a value: ``/joint_states.position[0]``."""
    return series.topic + "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in series.path)


def _panel(plot: Plot) -> dict[str, Any]:
    # One time for all series of a plot: a header's stamp only if all messages have one.
    time = "headerStamp" if all(series.stamped for series in plot.series) else "receiveTime"
    return {
        "foxglovePanelTitle": plot.title,
        "paths": [
            {"value": message_path(series), "label": series.label, "enabled": True, "timestampMethod": time}
            for series in plot.series
        ],
        "xAxisVal": "timestamp",
        "isSynced": True,
        "showXAxisLabels": True,
        "showYAxisLabels": True,
        "showLegend": True,
        "legendDisplay": "floating",
        "showPlotValuesInLegend": False,
        "sidebarDimension": 240,
    }


def _mosaic(ids: Sequence[str]) -> str | dict[str, Any]:
    """A tree that gives all panels the same height."""
    if len(ids) == 1:
        return ids[0]
    half = len(ids) // 2
    return {
        "direction": "column",
        "first": _mosaic(ids[:half]),
        "second": _mosaic(ids[half:]),
        "splitPercentage": round(100 * half / len(ids), 4),
    }
