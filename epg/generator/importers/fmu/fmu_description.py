# SPDX-License-Identifier: Apache-2.0
"""Reads the ``modelDescription.xml`` of FMI 2.0 and 3.0, and checks that a target can use the FMU."""

from __future__ import annotations

import re
from fractions import Fraction

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import one_line
from epg.generator.documents.xml_file import Element
from epg.generator.importers.fmu.fmu_variables import FmuVariable, read_variables
from epg.generator.models.assignments import exact_number, is_step
from epg.generator.source import Span


@dataclass(frozen=True)
class FmuDescription:
    """The data in the description that EPG needs.  ``standard`` is 2 or 3.

    ``step`` is the step of the default experiment, or else the internal step, in seconds; None if both are missing.
    ``once`` is True if a program can have only one instance.  ``sources`` are the files in ``<SourceFiles>`` of FMI
    2.0, each with its position; None if there is no such list.
    """

    standard: int
    version: str
    name: str
    guid: str
    tool: str
    identifier: str
    once: bool
    step: Fraction | None
    step_span: Span
    internal_step: Fraction | None
    variables: tuple[FmuVariable, ...]
    sources: tuple[tuple[str, Span], ...] | None
    span: Span

    @property
    def is_20sim(self) -> bool:
        return self.tool.startswith("20-sim")


def read_description(root: Element, diagnostics: Diagnostics) -> FmuDescription | None:
    """The description.  None if the FMU cannot be a model; the reasons are reported."""
    standard = _standard(root, diagnostics)
    interface = _interface(root, diagnostics) if standard is not None else None
    if standard is None or interface is None:
        return None
    identifier = interface.attributes.get("modelIdentifier", "")
    experiment = root.find("DefaultExperiment")
    step_span = experiment.span if experiment is not None else root.span
    step = _time(experiment, "stepSize", diagnostics)
    internal = _time(interface, "fixedInternalStepSize", diagnostics)
    guid = root.attributes.get("guid" if standard == 2 else "instantiationToken", "")
    return FmuDescription(
        standard=standard,
        version=_version(root),
        name=one_line(root.attributes.get("modelName", "") or identifier or "FMU"),
        guid=guid,
        tool=one_line(root.attributes.get("generationTool", "")),
        identifier=identifier,
        once=_flag(interface, "canBeInstantiatedOnlyOncePerProcess"),
        step=step or internal,
        step_span=step_span,
        internal_step=internal,
        variables=read_variables(root, standard, diagnostics),
        sources=_sources_2(interface) if standard == 2 else None,
        span=root.span,
    )


def _version(root: Element) -> str:
    return one_line(root.attributes.get("fmiVersion", ""))[:20]


def _standard(root: Element, diagnostics: Diagnostics) -> int | None:
    """2 or 3.  None, after an error, for other versions of FMI and other documents."""
    match = re.match(r"([23])\.", root.attributes.get("fmiVersion", ""))
    if root.name == "fmiModelDescription" and match is not None:
        return int(match[1])
    message = "this is not a description of an FMU"
    if root.name == "fmiModelDescription":
        message = f"this FMU has FMI version {_version(root) or 'unknown'}: EPG reads FMI 2.0 and 3.0"
    diagnostics.error("fmu-version", root.span, message, hint="export it as FMI 2.0 or 3.0 for co-simulation")
    return None


def _interface(root: Element, diagnostics: Diagnostics) -> Element | None:
    """The interface for co-simulation.  None, after an error, if a target cannot use it."""
    interface = root.find("CoSimulation")
    if interface is None:
        others = [name for name in ("ModelExchange", "ScheduledExecution") if root.find(name) is not None]
        message = f"this FMU is for {' and '.join(others) or 'nothing'} only: EPG needs CoSimulation"
        diagnostics.error("fmu-interface", root.span, message, hint="export it for co-simulation")
        return None
    if _flag(interface, "needsExecutionTool"):
        message = "this FMU runs only inside the program that exported it (needsExecutionTool)"
        diagnostics.error("fmu-needs-tool", interface.span, message, hint="export it stand-alone, with sources")
        return None
    return interface


def _flag(element: Element, name: str) -> bool:
    return element.attributes.get(name, "").strip() in ("true", "1")


def _time(element: Element | None, name: str, diagnostics: Diagnostics) -> Fraction | None:
    text = element.attributes.get(name) if element is not None else None
    if element is None or text is None:
        return None
    value = exact_number(text.strip())
    if value is None or not is_step(value):
        message = f"{name} is '{one_line(text)[:40]}', which is not a step in seconds"
        comma = re.fullmatch(r"\s*\d+,\d+\s*", text)
        hint = "write it with a decimal point" if comma else "a step must be from 1 ns to 1000000 s"
        diagnostics.error("fmu-step", element.span, message, hint=hint)
        return None
    return value


def _sources_2(interface: Element) -> tuple[tuple[str, Span], ...] | None:
    """The files in ``<SourceFiles>`` (FMI 2.0.4, section 4.3.1).  Their names are relative to ``sources``."""
    listed = interface.find("SourceFiles")
    if listed is None:
        return None
    return tuple((file.attributes.get("name", ""), file.span) for file in listed.children if file.name == "File")
