# SPDX-License-Identifier: Apache-2.0
"""``epg live``: shows the values of a running target, records them, and sends it commands."""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from epg.diagnostics import Diagnostics
from epg.source import Span

if TYPE_CHECKING:
    from epg.live.client import Client
    from epg.live.rows import Recording, Sink
    from epg.live.screen import Screen


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "port",
        type=Path,
        nargs="?",
        metavar="PORT",
        help="serial port, terminal of a host program, or udp:HOST:PORT; none: lists them",
    )
    parser.add_argument(
        "--baud", type=int, default=115200, metavar="N", help="bits per second of a UART; default: 115200"
    )
    parser.add_argument(
        "--signals", metavar="NAME,...", help="signals to show and to record; default: the first 32; none: no stream"
    )
    parser.add_argument(
        "--every",
        type=_whole,
        default=1,
        metavar="N",
        help="a row in every N-th control cycle; default: as often as possible",
    )
    parser.add_argument(
        "--send",
        action="append",
        default=[],
        metavar="LINE",
        help="a command of the console to send first; can be repeated",
    )
    parser.add_argument("--duration", type=float, metavar="SECONDS", help="length; default: until Ctrl-C")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="also writes the rows to a CSV file")
    parser.add_argument("--mcap", type=Path, metavar="FILE", help="also writes the rows for PlotJuggler and Foxglove")
    parser.add_argument(
        "--record", type=Path, metavar="FILE", help="also writes a recording for 'epg replay', with every control cycle"
    )
    parser.add_argument(
        "--keep", type=Path, metavar="FILE", help="writes the changed parameters into the bindings FILE, and ends"
    )
    parser.add_argument("--force", action="store_true", help="overwrite these files")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.edit.yaml_edit import CannotEdit
    from epg.live.client import Client, Lost, Refused
    from epg.live.open import open_port
    from epg.live.port import PortError
    from epg.live.rows import Recording, Stream
    from epg.live.screen import Screen, Values
    from epg.live.udp import PortTaken, disable, is_udp

    if options.port is None:
        return _list(options)
    for file in (options.csv, options.mcap, options.record):
        if file is not None and file.exists() and not options.force:
            diagnostics.error("file-exists", Span(str(file)), "this file exists", hint="--force overwrites it")
    if options.record is not None and (options.signals is not None or options.every != 1):
        message = "a recording for a replay has all ports of the model in every control cycle"
        option = "--signals" if options.signals is not None else "--every"
        hint = f"remove {option}, or record with --csv or --mcap"
        diagnostics.error("record-all", Span.of_argument(str(options.record), "--record"), message, hint=hint)
    kept = diagnostics.checked(_bindings(options.keep, diagnostics)) if options.keep is not None else ""
    diagnostics.stop_if_errors()
    relay = _Relay()
    try:
        if options.send[:1] == ["disable"] and is_udp(options.port):
            disable(options.port)  # this acts at once, also while another program uses the target
        with open_port(options.port, options.baud) as port:
            client = Client(port, relay.told, relay.numbered)
            try:
                names = _chosen(client, options)
                values = Values(len(names))
                shows = sys.stdin.isatty() and sys.stdout.isatty() and not options.json and not options.keep
                with _sinks(options, client, names) as sinks:
                    recording = Recording(Stream(names), [*sinks, values] if shows else sinks)
                    _start(recording, client, names, options)
                    for line in options.send:
                        answer = client.command("enable leased" if line == "enable" else line)
                        if not shows and not options.json:
                            print("\n".join(answer), flush=True)
                    end = time.monotonic() + options.duration if options.duration is not None else float("inf")
                    if shows:
                        relay.screen = Screen(client, names, values, recording, relay.faults)
                        relay.screen.run(end)
                    elif options.duration is not None or not (options.send or options.keep):
                        relay.wait(client, recording, end)
                    if names and not relay.lost:
                        client.stop_stream()
                    recording.drain()
                if not options.json and names:
                    stream = recording.stream
                    print(f"{stream.rows} rows, {stream.dropped} dropped, {client.damaged} damaged frames")
                if options.record is not None and recording.stream.dropped:
                    sys.stderr.write(_DROPPED)
                if not relay.lost and (options.keep is not None or not options.json):
                    _keep(client, options, kept)
            finally:
                client.stop()
    except PortError as problem:
        if isinstance(problem, PortTaken) and options.send == ["disable"]:
            print("ok disable")
            return 0
        diagnostics.error("live-port", Span(str(options.port)), str(problem), hint=problem.hint)
    except Refused as problem:
        return _failed(
            options, f"the target refused it: {problem}", "the command 'help' lists the commands, 'ports' the names"
        )
    except CannotEdit as problem:
        return _failed(options, f"the bindings were not changed: {problem}", "write the parameters into the file")
    except Lost as problem:
        relay.lost = relay.lost or str(problem)
    if relay.lost:
        hint = (
            "the firmware needs the console on this port; reset the board, look at the cable; with a UART, check --baud"
        )
        if is_udp(options.port):
            hint = "look at the program and at the network, and connect again"
        return _failed(options, relay.lost, hint)
    return 0


_DROPPED = """A replay is not possible over dropped rows.
hint: a larger 'capture' in 'communication' of the .tcf keeps more rows in memory
"""


def _bindings(file: Path, diagnostics: Diagnostics) -> str | None:
    """The text of bindings; None after a message if they have a mistake."""
    from epg.documents.schema import load_schema, validate
    from epg.documents.text_file import read_text
    from epg.documents.yaml_file import parse_yaml

    text = read_text(file, diagnostics)
    root = parse_yaml(text, str(file), diagnostics) if text is not None else None
    return text if root is not None and validate(root, load_schema("bindings"), diagnostics) else None


def _keep(client: Client, options: argparse.Namespace, bindings: str) -> None:
    """Writes the changed parameters into the bindings, or says which ones there are.

    :raises Lost: the target does not answer
    """
    from epg.edit.parameters import set_parameters
    from epg.live.client import Refused

    try:
        changed = {each.name: each.value for each in client.parameters() if each.value != each.generated}
    except Refused:  # a target without parameters
        changed = {}
    said = " ".join(f"{name}={value!r}" for name, value in changed.items())
    if options.keep is not None:
        text = set_parameters(bindings, str(options.keep), changed)
        if text != bindings:
            options.keep.write_text(text, encoding="utf-8", newline="")
        if not options.json:
            print(f"{options.keep} has {said}" if changed else "no parameter differs from those of the firmware")
    elif changed:
        print(f"changed parameters: {said}")
        print(f"hint: 'epg live {options.port} --keep {client.description.name}.bindings.yaml' keeps them")


def _failed(options: argparse.Namespace, message: str, hint: str) -> int:
    """Says why it cannot go on with the target.  Returns the exit status."""
    sys.stderr.write(f"epg: {options.port}: {message}\nhint: {hint}\n")
    return 1


class _Relay:
    """Passes lines and numbers to the screen, or answers without one."""

    def __init__(self) -> None:
        from epg.cli.arguments import user_roots
        from epg.data import targets_roots
        from epg.live.faults import Faults

        self.screen: Screen | None = None
        self.lost = ""
        self.faults = Faults(targets_roots(user_roots()))
        self._numbers: list[int] = []
        self._states: list[str] = []

    def told(self, line: str) -> None:
        if line.startswith("lost "):
            self.lost = line.removeprefix("lost ")
        if self.screen is not None:
            self.screen.told(line)
        elif line.startswith("state "):
            self._states.append(line)

    def numbered(self, number: int) -> None:
        if self.screen is not None:
            self.screen.numbered(number)
        else:
            self._numbers.append(number)

    def wait(self, client: Client, recording: Recording, end: float) -> None:
        """Waits until Ctrl-C, until the connection is lost, or until the monotonic time ``end``."""
        stopped: list[int] = []
        before = {
            number: signal.signal(number, lambda number, _: stopped.append(number))
            for number in (signal.SIGINT, signal.SIGTERM)
        }
        try:
            while not stopped and not self.lost and time.monotonic() < end:
                while self._numbers:
                    client.respond(self._numbers.pop(0))
                recording.drain()
                self._explain()
                time.sleep(0.02)
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _explain(self) -> None:
        """Says a new fault in words."""
        from epg.live.client import words_of

        while self._states:
            fault = self.faults.explain(dict(words_of(self._states.pop(0))))
            if fault is not None:
                sys.stderr.write(f"{fault.text}\nhint: {fault.remedy}\n")


def _chosen(client: Client, options: argparse.Namespace) -> list[str]:
    """The names of the signals of ``--signals``.

    :raises Refused: the target does not have them
    """
    from epg.diagnostics import did_you_mean
    from epg.live.client import Refused

    known = [signal.name for signal in client.description.streamed]
    if options.record is not None:
        from epg.live.recording import signals_to_record

        return signals_to_record(client.description)
    if options.signals is None:
        return [signal.name for signal in client.description.signals[:32]] if options.keep is None else []
    names = []
    for word in options.signals.split(",") if options.signals != "none" else ():
        ports = [name for name in known[: len(client.description.signals)] if word in (name, name.split(".", 1)[-1])]
        # A port of the model has precedence: its short name can also be that of an actuator or an encoder.
        found = ports or [name for name in known if word in (name, name.split(".", 1)[-1])]
        if len(found) != 1:
            problem = f"there is no signal '{word}'" if not found else f"several signals have the name '{word}'"
            raise Refused(f"{problem} ({did_you_mean(word, known, 'signals')})")
        names += found
    if len(names) > 32:
        raise Refused(f"a stream has at most 32 signals, not {len(names)}")
    return names


@contextlib.contextmanager
def _sinks(options: argparse.Namespace, client: Client, names: list[str]) -> Iterator[list[Sink]]:
    """The files of the command line, open."""
    from epg import bootstrap
    from epg.live.recording import ReplayFile
    from epg.live.rows import CsvFile, JsonLines, McapFile

    sinks: list[Sink] = []
    try:
        if options.csv is not None:
            sinks.append(CsvFile(options.csv, names))
        if options.mcap is not None:
            bootstrap.ensure("mcap")
            sinks.append(McapFile(options.mcap, names, f"/{client.description.node or 'target'}", time.time_ns()))
        if options.record is not None:
            sinks.append(ReplayFile(options.record, client))
        if options.json:
            sinks.append(JsonLines(sys.stdout, names))
        yield sinks
    finally:
        for sink in sinks:
            sink.close()


def _start(recording: Recording, client: Client, names: list[str], options: argparse.Namespace) -> None:
    if not names:
        return
    known = [signal.name for signal in client.description.streamed]
    if options.record is not None and "enabled=1" in client.command("stats")[0].split(" "):
        sys.stderr.write("the target is enabled already: a replay begins at its next enabling\n")
    indices = [known.index(name) for name in names]
    every = recording.start(client, indices, options.every, exact=options.record is not None)
    if every != options.every and not options.json:
        sys.stderr.write(f"a row in every {every}th control cycle: the port carries no more\n")


def _list(options: argparse.Namespace) -> int:
    from epg.cli.report import to_json
    from epg.cli.table import table
    from epg.live.found import look_at_all, ports

    found = look_at_all(ports())
    if options.json:
        data = [
            {
                "port": str(one.path),
                "device": one.device,
                "name": one.target.name if one.target else None,
                "hash": one.target.hash if one.target else None,
                "reason": one.reason,
            }
            for one in found
        ]
        sys.stdout.write(to_json({"ports": data}))
    elif found:
        rows = [
            (str(one.path), f"{one.target.name}, EPG {one.target.version}" if one.target else one.reason, one.device)
            for one in found
        ]
        print(table(("port", "target", "device"), rows))
    else:
        print("there are no serial ports; a host program has one with --console-pty PATH, or --console-udp PORT")
    return 0


def _whole(text: str) -> int:
    if not text.isdigit() or int(text) == 0:
        raise argparse.ArgumentTypeError("must be a whole number of 1 or more")
    return int(text)
