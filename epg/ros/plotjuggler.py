# SPDX-License-Identifier: Apache-2.0
"""Writes plots as a layout of PlotJuggler 3.

PlotJuggler reads it in ``MainWindow::xmlLoadState()``, ``PlotDocker::restoreSplitter()`` and
``PlotWidget::xmlLoadState()``.  The names of curves are those that its ParserROS makes of a message:
``<topic>/<field>``, ``<topic>/<field>[<index>]``, and for joints ``<topic>/<joint>/<quantity>``.
"""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from epg.ros.plots import Plot, Series

_COLOURS = ("#1f77b4", "#d62728", "#1ac938", "#ff7f0e", "#9467bd", "#17becf", "#bcbd22", "#f14cc1")
_ERROR_COLOUR = "#7f7f7f"
_COLUMN = 4  # the largest number of plots in a column


def plotjuggler_layout(title: str, plots: Sequence[Plot]) -> str:
    """The text of a layout with one tab.  A plot of a setpoint also has the error, setpoint - measured value."""
    root = Element("root")
    tabs = SubElement(root, "tabbed_widget", {"name": "Main Window", "parent": "main_window"})
    tab = SubElement(tabs, "Tab", tab_name=title, containers="1")
    container = SubElement(tab, "Container")
    columns = [plots[at : at + _COLUMN] for at in range(0, len(plots), _COLUMN)]
    outer = _splitter(container, "|", len(columns)) if len(columns) > 1 else container
    for column in columns:
        splitter = _splitter(outer, "-", len(column))
        for plot in column:
            _plot(SubElement(splitter, "DockArea", name=plot.title), plot)
    SubElement(tabs, "currentTabIndex", index="0")
    SubElement(root, "use_relative_time_offset", enabled="1")
    equations = SubElement(root, "customMathEquations")
    for plot in plots:
        if plot.setpoint and plot.measured:
            _equation(equations, plot.setpoint, plot.measured[0])
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"


def curve_name(series: Series) -> str:
    """The name that PlotJuggler gives to the values of a series."""
    if series.joint:
        return f"{series.topic}/{series.joint}/{series.path[0]}"
    return series.topic + "".join(f"[{part}]" if isinstance(part, int) else f"/{part}" for part in series.path)


def _splitter(parent: Element, orientation: str, count: int) -> Element:
    sizes = ";".join([f"{1 / count:.6g}"] * count)
    return SubElement(parent, "DockSplitter", orientation=orientation, count=str(count), sizes=sizes)


def _plot(parent: Element, plot: Plot) -> None:
    element = SubElement(
        parent, "plot", mode="TimeSeries", style="Lines", line_width="1.5", flip_x="false", flip_y="false"
    )
    SubElement(element, "limitY")
    for number, series in enumerate(plot.series):
        SubElement(element, "curve", name=curve_name(series), color=_COLOURS[number % len(_COLOURS)])
    if plot.setpoint and plot.measured:
        SubElement(element, "curve", name=_error_name(plot.measured[0]), color=_ERROR_COLOUR)


def _error_name(measured: Series) -> str:
    return f"error/{measured.label}"


def _equation(parent: Element, setpoint: Series, measured: Series) -> None:
    """A curve in PlotJuggler's Lua: ``value`` is the linked source, ``v1`` the last value of the other curve."""
    snippet = SubElement(parent, "snippet", name=_error_name(measured), language="lua")
    SubElement(snippet, "global")
    SubElement(snippet, "function").text = "return v1 - value"
    SubElement(snippet, "linked_source").text = curve_name(measured)
    SubElement(SubElement(snippet, "additional_sources"), "v1").text = curve_name(setpoint)
