# SPDX-License-Identifier: Apache-2.0
"""A connection to a running target: its description, commands, streams, and enabling on a lease.

>>> # client = Client(SerialPort(Path("/dev/ttyACM0"))); client.command("get")
"""

from __future__ import annotations

import contextlib
import struct
import threading
import time
from array import array
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol

from epg.live.frames import Decoder, encode
from epg.live.port import PortError

PATIENCE = 1.0
"""Seconds to wait for an answer before a command is sent again or has failed."""
KEEP = 0.5
"""Seconds between two signs of life to the target.  It ends streams after 2 s without one."""
EXACT = 0xFFFF
"""In the place of the first signal of a stream: the values are doubles."""
AGAIN = ("get", "set", "ports", "version", "stats", "disable")
"""Commands that have the same effect if they are carried out twice."""


def now() -> float:
    """Seconds of a clock that goes on while this computer is suspended, if it has one."""
    return time.clock_gettime(_CLOCK) if _CLOCK is not None else time.monotonic()


_CLOCK: int | None = getattr(time, "CLOCK_BOOTTIME", None)


class Carrier(Protocol):
    """An open port."""

    def read(self, seconds: float) -> bytes: ...
    def write(self, data: bytes) -> None: ...


class CommandRefused(Exception):
    """The target refused a command, for the reason in its text."""


class Lost(Exception):
    """The target does not answer, or its port is gone."""


@dataclass(frozen=True)
class StreamedSignal:
    """A signal that can be streamed."""

    name: str
    unit: str


@dataclass(frozen=True)
class Setpoint:
    """A setpoint.  A target of an earlier EPG tells its name only."""

    name: str
    unit: str
    low: float | None  # the smallest value that the target accepts; None: any
    high: float | None
    follows: str  # the signal at whose value enabling begins; empty: none
    fresh: bool  # values that were sent before the enabling do not act
    starts: float | None  # the value that an enabling now would begin with; None: a measured one, or not known


@dataclass(frozen=True)
class TunableParameter:
    """A parameter of the model.  ``generated`` is the value that the firmware was built with."""

    name: str
    value: float
    generated: float
    unit: str
    low: float | None  # the smallest possible value; None: any
    high: float | None


@dataclass(frozen=True)
class TargetDescription:
    """The description that a target gives of itself."""

    name: str
    node: str
    version: str
    hash: str
    model: str  # identifies the model and the generated values of its parameters; empty for a target of an earlier EPG
    period: float  # of the control cycle, in seconds
    setpoints: tuple[Setpoint, ...]
    publications: tuple[str, ...]
    signals: tuple[StreamedSignal, ...]  # the ports of the model
    loop: tuple[StreamedSignal, ...]  # durations of the control loop; empty for a target of an earlier EPG
    replay: tuple[
        StreamedSignal, ...
    ]  # the values that a replay needs beside the signals; empty for a target of an earlier EPG
    duties: tuple[StreamedSignal, ...]  # the present duties of the actuators
    positions: tuple[StreamedSignal, ...]  # of the encoders
    actuators: tuple[str, ...]
    encoders: tuple[str, ...]
    parameters: tuple[TunableParameter, ...]

    @property
    def streamed(self) -> tuple[StreamedSignal, ...]:
        """All signals of a stream, in the order of their indices."""
        return self.signals + self.loop + self.replay + self.duties + self.positions


@dataclass(frozen=True)
class Rows:
    """Rows of a stream in their order.  ``number`` and ``tick`` (s) are those of the first row."""

    number: int
    tick: float
    values: array[float]


class _Answer:
    """The answer to one command, while it arrives."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.over = threading.Event()


class Client:
    """A connection to a target.  Its methods may be called from every thread.

    ``told`` gets lines that answer no command ("state enabled=0 ..."), and a reason after "lost " when the connection
    ends.  ``numbered`` gets each number that a target sends, on a lease or while it is moved by hand; :meth:`respond`
    sends it back.  Both are called from the thread that reads, and must return at once.  A command that may be repeated
    is sent ``tries`` times, at least ``patience`` seconds apart.

    ``state`` has the words of the target's newest state: {"enabled": "0", "fault": "none", "stop": "1f00c2d9-3"}.  On a
    lease, it has "leased", too.  ``number`` is the newest number of the target; 0: there was none.

    :raises Lost: the target does not answer
    """

    def __init__(
        self,
        port: Carrier,
        told: Callable[[str], None] | None = None,
        numbered: Callable[[int], None] | None = None,
        *,
        tries: int = 3,
        patience: float = PATIENCE,
    ) -> None:
        self._port = port
        self._tries, self._patience = tries, patience
        self._told = told or (lambda line: None)
        self._numbered = numbered or self.respond
        self._rows: Callable[[Rows], None] | None = None
        self._writing = threading.Lock()
        self._commanding = threading.Lock()
        self._tag = 0
        self._answers: dict[int, _Answer] = {}
        self._over = threading.Event()
        self._lost = ""
        self._heard = now()  # the time of the newest message, and of the newest rows
        self._rows_heard = 0.0
        self.damaged = 0
        self.number = 0
        self.state: dict[str, str] = {}
        self._leased = False  # this program has enabled the target on a lease
        self._thread = threading.Thread(target=self._read, name="epg live", daemon=True)
        self._thread.start()
        try:
            self.description = self._describe()
        except BaseException:
            self.stop()
            raise

    # Commands

    def command(self, line: str) -> list[str]:
        """Sends a line of the console and returns the lines of its answer, the last of which begins with "ok".

        :raises Refused: the target refused it
        :raises Lost: there is no answer
        """
        with self._commanding:
            return self._ask(b"C", line.encode("ascii"), line.split(" ")[0])

    def enable(self, after: str = "", *, unattended: bool = False) -> list[str]:
        """Enables the target on a lease; ``unattended``: without one, so that it stays enabled when this program ends.

        ``after`` is the number of the newest stop that the person knew, or the newest one of :attr:`state`.  The target
        refuses to be enabled if another stop has come since.

        :raises Refused: the target refused it
        :raises Lost: there is no answer
        """
        if not self.state:  # no control cycle had run
            self.command("stats")
        known = after or self.state.get("stop", "")
        line = f"enable {'unattended' if unattended else 'leased'} after={known}"
        if not known:  # a target of an earlier EPG
            line = "enable" if unattended else "enable leased"
        self._leased = not unattended
        try:
            return self.command(line)
        except CommandRefused:
            self._leased = False
            raise

    @property
    def age(self) -> float:
        """Seconds since the newest rows of the stream have arrived; without a stream, since the newest message."""
        return now() - (self._rows_heard or self._heard)

    def disable(self) -> None:
        """Disables the target.  It does not wait for other commands.

        :raises Lost: there is no answer
        """
        self._ask(b"C", b"disable", "disable")

    def move(self, actuator: str, duty: float, number: int | None = None, milliseconds: int = 250) -> None:
        """Moves an actuator of a disabled target for a short time.  The same call before its end prolongs the movement.

        The movement ends ``milliseconds`` after the command has arrived, and at the latest 300 ms after the target has
        sent ``number``: the newest one that the operator had got at this time.  None: :attr:`number`.  A number that is
        too old does not move anything; the target then sends newer ones, for 300 ms.  So call it about every 50 ms.

        It returns at once.  The lines that the encoders have moved by answer the command that begins a movement, and go
        to ``told``.
        """
        line = f"jog {actuator} {duty!r} {milliseconds} number={self.number if number is None else number}"
        with contextlib.suppress(PortError):
            self._send(b"C\0" + line.encode("ascii"))

    def respond(self, number: int) -> None:
        """Sends a number back."""
        with contextlib.suppress(PortError):
            self._send(b"R" + number.to_bytes(4, "little"))

    def start_stream(
        self, signals: Sequence[int], every: int, rows: Callable[[Rows], None], *, exact: bool = False
    ) -> None:
        """Starts to stream the signals with these indices, a row in every ``every``-th control cycle.

        ``rows`` is called from the thread that reads.  With ``exact``, the values have all bits.

        :raises Refused: the target refused it
        :raises Lost: there is no answer
        """
        indices = [EXACT, *signals] if exact else signals
        data = struct.pack(f"<I{len(indices)}H", every, *indices)
        with self._commanding:
            self._rows = rows
            self._ask(b"S", data, "stream")
            self._rows_heard = now()

    def stop_stream(self) -> None:
        """Ends the stream.

        :raises Lost: there is no answer
        """
        with self._commanding:
            self._ask(b"S", b"", "stream")
            self._rows = None
            self._rows_heard = 0.0

    def parameters(self) -> tuple[TunableParameter, ...]:
        """The model's parameters with their present values.

        :raises Lost: there is no answer
        """
        return tuple(_parameter(line) for line in self.command("get") if line.startswith("parameter "))

    def setpoints(self) -> tuple[Setpoint, ...]:
        """The setpoints; ``starts`` of each is that of now."""
        return _setpoints(self.command("ports"))

    def stop(self) -> None:
        """Ends the connection, without closing the port.  A target that was enabled on a lease becomes disabled."""
        self._over.set()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _describe(self) -> TargetDescription:
        words = dict(words_of(self.command("version")[-1]))
        with contextlib.suppress(CommandRefused):  # no control cycle has run yet
            self.command("stats")
        lines = self.command("ports")
        ports = [line.split(" ") for line in lines if line.startswith("port ")]

        def names(category: str) -> tuple[str, ...]:
            return tuple(port[2] for port in ports if port[1] == category)

        def signals(category: str, prefix: str) -> tuple[StreamedSignal, ...]:
            found = [port for port in ports if port[1] == category]
            return tuple(StreamedSignal(prefix + p[2], p[3].removeprefix("unit=") if len(p) > 3 else "") for p in found)

        try:
            parameters = self.parameters()
        except CommandRefused:
            parameters = ()
        return TargetDescription(
            name=words.get("name", ""),
            node=words.get("node", ""),
            version=words.get("epg", ""),
            hash=words.get("hash", ""),
            model=words.get("model", ""),
            period=float(words.get("period", "0.001")),
            setpoints=_setpoints(lines),
            publications=names("publication"),
            signals=signals("signal", ""),
            loop=signals("loop", "loop."),
            replay=signals("replay", "replay."),
            duties=signals("actuator", "actuators."),
            positions=signals("encoder", "encoders."),
            actuators=names("actuator"),
            encoders=names("encoder"),
            parameters=parameters,
        )

    # Messages

    def _send(self, message: bytes) -> None:
        with self._writing:
            self._port.write(encode(message))

    def _ask(self, kind: bytes, data: bytes, command: str) -> list[str]:
        for _ in range(self._tries if command in AGAIN else 1):
            answer = _Answer()
            with self._writing:
                self._tag = self._tag % 255 + 1
                tag = self._tag
                self._answers[tag] = answer
            try:
                self._send(kind + bytes([tag]) + data)
                heard = -1
                while not answer.over.wait(self._patience) and len(answer.lines) > heard and not self._lost:
                    heard = len(answer.lines)  # a long answer takes its time
            except PortError as error:
                raise Lost(str(error)) from error
            finally:
                self._answers.pop(tag, None)
            if self._lost:
                raise Lost(self._lost)
            if self._over.is_set() and not answer.lines:
                raise Lost("the connection was ended")
            if answer.over.is_set():
                if answer.lines[-1].startswith("error "):
                    raise CommandRefused(answer.lines[-1].split(" ", 2)[-1])
                return answer.lines
        raise Lost(f"the target does not answer '{command}'")

    def _read(self) -> None:
        decoder = Decoder()
        keep = time.monotonic()
        try:
            while not self._over.is_set():
                if time.monotonic() >= keep:
                    self._send(b"K")
                    keep = time.monotonic() + KEEP
                for part in decoder.feed(self._port.read(0.1)):
                    self._take(part)
                self.damaged = decoder.damaged
        except PortError as error:
            self._lost = str(error)
            self._told(f"lost {error}")
        except Exception as error:
            self._lost = f"EPG cannot read from the target: {error!r}"
            raise
        finally:
            self._over.set()
            for answer in list(self._answers.values()):
                answer.over.set()

    def _take_state(self, state: dict[str, str]) -> None:
        if state.get("enabled") != "1":
            self._leased = False
        elif self._leased:
            state["leased"] = "1"
        self.state = state

    def _take(self, part: bytes | str) -> None:
        if isinstance(part, str):
            return  # lines from the time before the first frame
        kind, data = part[:1], part[1:]
        self._heard = now()
        if kind == b"A" and data:
            answer = self._answers.get(data[0])
            line = data[1:].decode("ascii", "replace")
            if line.startswith(("state ", "stat enabled=")):
                self._take_state(dict(words_of(line)))
            if answer is None:
                if data[0] == 0:
                    self._told(line)
                return
            answer.lines.append(line)
            if line.startswith(("ok ", "error ")):
                answer.over.set()
        elif kind == b"N" and len(data) == 4:
            self.number = int.from_bytes(data, "little")
            self._numbered(self.number)
        elif kind in b"DE" and len(data) >= 12 and self._rows is not None:
            number, tick_ns = struct.unpack_from("<IQ", data)
            values = array("f" if kind == b"D" else "d")
            values.frombytes(data[12 : len(data) - (len(data) - 12) % values.itemsize])
            self._rows_heard = self._heard
            self._rows(Rows(number, tick_ns / 1e9, values))


def words_of(line: str) -> list[tuple[str, str]]:
    """The words "name=value" of a line.

    >>> words_of("state enabled=0 fault=none")
    [('enabled', '0'), ('fault', 'none')]
    """
    return [(name, value) for name, sign, value in (word.partition("=") for word in line.split(" ")) if sign]


def _setpoints(lines: Iterable[str]) -> tuple[Setpoint, ...]:
    """The setpoints of the answer to ``ports``."""
    return tuple(_setpoint(line) for line in lines if line.startswith("port setpoint "))


def _setpoint(line: str) -> Setpoint:
    """The setpoint of a line "port setpoint pan unit=rad min=0 max=3 starts=0"."""
    name = line.split(" ")[2]
    known = dict(words_of(line))
    low, high, starts = (float(known[key]) if key in known else None for key in ("min", "max", "starts"))
    return Setpoint(name, known.get("unit", ""), low, high, known.get("follows", ""), known.get("fresh") == "1", starts)


def _parameter(line: str) -> TunableParameter:
    """The parameter of a line "parameter Pan\\\\PID\\\\kp=2.2 generated=2.6 unit=s min=0 max=5"."""
    (name, value), *others = words_of(line)
    known = dict(others)
    low, high = (float(known[key]) if key in known else None for key in ("min", "max"))
    return TunableParameter(name, float(value), float(known.get("generated", value)), known.get("unit", ""), low, high)
