# SPDX-License-Identifier: Apache-2.0
"""The data of a system file, with ``count`` and lists expanded: each target and each connection is one item."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from fractions import Fraction
from pathlib import Path
from types import MappingProxyType

from epg.generator.check.topic_ends import TopicEnd
from epg.generator.dataclass import dataclass
from epg.generator.project import Request, SystemPart
from epg.generator.source import Span, YamlNode


@dataclass(frozen=True)
class SimulatedClock:
    """The clock of a target in a simulation: the time of the first tick in s, and the drift in parts per 10^9."""

    start: Fraction = Fraction(0)
    drift: int = 0


@dataclass(frozen=True)
class Transport:
    """The way of the messages of a connection in a simulation: times in s, and the share of lost messages."""

    delay: Fraction = Fraction(1, 1000)
    jitter: Fraction = Fraction(0)
    loss: float = 0.0


@dataclass(frozen=True)
class SystemTarget:
    """One target.  ``settings`` is a part of a ``.tcf``.  ``span`` is the position of the name.

    ``serial`` is the serial number of the board, ``probe`` that of its debug probe.  ``project`` is the folder of the
    firmware project that builds its image, None for EPG's own.
    """

    name: str
    tcf: str
    model: Path
    bindings: Path
    plant: Path | None
    plant_bindings: Path | None
    settings: YamlNode | None
    serial: str | None
    probe: str | None
    project: Path | None
    clock: SimulatedClock
    span: Span


@dataclass(frozen=True)
class SystemPlant:
    """The plant of the whole system: a model, and its bindings to components of targets.

    ``period`` is its step in seconds; None: the step of the model.
    """

    model: Path
    bindings: Path
    period: Fraction | None
    span: Span
    period_span: Span


@dataclass(frozen=True)
class End:
    """A port of a target: a topic component, one of its ports, or a port of the model.

    ``topic`` is the name that the file gives to a topic of the world, or empty.
    """

    target: str
    port: str
    span: Span
    topic: str = ""

    def __str__(self) -> str:
        return f"{self.target}/{self.port}"

    @property
    def component(self) -> str:
        """The name of the topic component."""
        return self.port.partition(".")[0]


@dataclass(frozen=True)
class Connection:
    """A value that one target sends to another one.  ``parameters`` are those of both topic components."""

    sender: End
    receiver: End
    parameters: Mapping[str, YamlNode] = field(default_factory=lambda: MappingProxyType({}))
    transport: Transport = field(default_factory=Transport)


@dataclass(frozen=True)
class System:
    """A system file.  ``world`` are the ports that other programs send to."""

    name: str
    path: Path
    targets: Mapping[str, SystemTarget]
    connections: Sequence[Connection]
    world: Sequence[End]
    plant: SystemPlant | None = None

    def request(self, target: SystemTarget, user_roots: Sequence[Path] = (), ioc: Path | None = None) -> Request:
        """The request of one target.  It depends on this file and on the target's own files only."""
        namespace = YamlNode(f"/{self.name}/{target.name}", target.span)
        keys = MappingProxyType({"namespace": target.span})
        part = YamlNode(MappingProxyType({"namespace": namespace}), target.span, keys)
        parts = (part,) if target.settings is None else (part, target.settings)
        return Request(
            name=target.name,
            tcf=target.tcf,
            model=target.model,
            bindings=target.bindings,
            plant=target.plant,
            plant_bindings=target.plant_bindings,
            user_roots=user_roots,
            ioc=ioc,
            caller=target.span,
            beside=self.path.parent,
            system=SystemPart(self.path, parts, tuple(self._ends(target.name))),
        )

    def simulated(self, target: SystemTarget, name: str, user_roots: Sequence[Path] = ()) -> Request:
        """The request of one target as a part of the simulation, where its C symbols begin with ``name``."""
        request = self.request(target, user_roots)
        assert request.system is not None
        return replace(request, name=name, system=replace(request.system, simulated=True))

    def topic(self, sender: End) -> str:
        """The topic on which ``sender`` is sent, or received from other programs."""
        return f"/{self.name}/{sender.topic or f'{sender.target}/{sender.component}'}"

    def _ends(self, target: str) -> list[TopicEnd]:
        """The ends of a target.  Connections with the same topic component have one end."""
        ends: dict[tuple[str, bool], TopicEnd] = {}
        for connection in self.connections:
            for end, receives in ((connection.sender, False), (connection.receiver, True)):
                if end.target == target:
                    made = TopicEnd(end.port, self.topic(connection.sender), receives, connection.parameters, end.span)
                    ends.setdefault((end.component, receives), made)
        for end in self.world:
            if end.target == target:
                made = TopicEnd(end.port, self.topic(end), True, {}, end.span)
                ends.setdefault((end.component, True), made)
        return list(ends.values())
