# SPDX-License-Identifier: Apache-2.0
"""``epg live``: shows the values of a running target, records them, and sends it commands."""

from __future__ import annotations

import argparse
import contextlib
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from epg.cli.arguments import user_roots
from epg.cli.progress import StopRequest
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span

if TYPE_CHECKING:
    from epg.live.client import Client, TargetDescription
    from epg.live.port import SerialPort
    from epg.live.rows import File, Recorder, Stream
    from epg.live.screen import Screen
    from epg.live.udp import UdpPort


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
    parser.add_argument(
        "--unattended", action="store_true", help="confirms --send 'enable unattended', which is without a lease"
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
    parser.add_argument(
        "--key",
        type=Path,
        metavar="FILE",
        help="a file with the key of udp:HOST:PORT; the key is kept for the next time",
    )
    parser.add_argument("--force", action="store_true", help="overwrite these files")


def run(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.edit.yaml_edit import CannotEdit
    from epg.live.client import CommandRefused, Lost
    from epg.live.port import PortError
    from epg.live.udp import PortLocked, PortTaken

    if options.port is None:
        return _list(options, diagnostics)
    kept = _checked(options, diagnostics)
    relay = _Relay()
    try:
        _prepare(options)
        try:
            port = _open(options)
        except (PortTaken, PortLocked):
            if options.send != ["disable"]:
                raise
            print("ok disable")  # the target has confirmed it before
            return 0
        with port:
            _talk(port, options, relay, kept)
    except PortError as problem:
        diagnostics.error("live-port", Span(str(options.port)), str(problem), hint=problem.hint)
    except CommandRefused as problem:
        return _failed(
            options, f"the target refused it: {problem}", "the command 'help' lists the commands, 'ports' the names"
        )
    except CannotEdit as problem:
        return _failed(options, f"the bindings were not changed: {problem}", "write the parameters into the file")
    except Lost as problem:
        relay.lost = relay.lost or str(problem)
    return _failed(options, relay.lost, _hint_if_lost(options.port)) if relay.lost else 0


def _checked(options: argparse.Namespace, diagnostics: Diagnostics) -> str:
    """The text of the bindings of ``--keep``, else empty.  Stops after reporting options that are not possible."""
    from epg.cli.arguments import refuse_existing

    refuse_existing((options.csv, options.mcap, options.record), options.force, diagnostics)
    if options.record is not None and (options.signals is not None or options.every != 1):
        message = "a recording for a replay has all ports of the model in every control cycle"
        option = "--signals" if options.signals is not None else "--every"
        hint = f"remove {option}, or record with --csv or --mcap"
        diagnostics.error("record-all", Span.of_argument(str(options.record), "--record"), message, hint=hint)
    _check_unattended(options, diagnostics)
    kept = diagnostics.checked(_bindings(options.keep, diagnostics)) if options.keep is not None else ""
    diagnostics.stop_if_errors()
    return kept


def _prepare(options: argparse.Namespace) -> None:
    """Keeps the key, and disables the target at once, also while another program uses it.

    :raises PortError: the target does not answer, or the key cannot be used
    """
    from epg.live.udp import disable, is_udp
    from epg.live.udp_keys import keep_key

    if options.key is not None:
        keep_key(options.port, _text_of(options.key))
    if options.send[:1] == ["disable"] and is_udp(options.port):
        disable(options.port)


def _talk(port: SerialPort | UdpPort, options: argparse.Namespace, relay: _Relay, kept: str) -> None:
    """All work with the open port.  ``kept`` is the text of the bindings.

    :raises Refused: the target refused a command
    :raises CannotEdit: the bindings cannot have the parameters
    :raises Lost: the target does not answer
    """
    from epg.live.client import Client

    client = Client(port, relay.told, relay.numbered)
    try:
        names = _chosen(client, options)
        stream = _stream(client, options, relay, names)
        if not options.json and names:
            print(f"{stream.rows} rows, {stream.dropped} dropped, {client.damaged} damaged frames")
        if options.record is not None and stream.dropped:
            sys.stderr.write(_DROPPED)
        if not relay.lost and (options.keep is not None or not options.json):
            _keep(client, options, kept)
    finally:
        client.stop()


def _stream(client: Client, options: argparse.Namespace, relay: _Relay, names: list[str]) -> Stream:
    """Streams the signals ``names`` into the files and onto the screen until the end.  Returns the finished stream."""
    from epg.live.rows import JsonLines, Recorder, Stream
    from epg.live.screen import Screen, Values

    values = Values(len(names))
    shows = _has_screen(options)
    with _files(options, client, names) as files, StopRequest() as stop:
        more = [JsonLines(sys.stdout, names)] if options.json else [values] if shows else []
        recording = Recorder(Stream(names), [*files, *more], files)
        _start(recording, client, names, options)
        _send(client, options.send, stop, quiet=shows or options.json)
        end = time.monotonic() + options.duration if options.duration is not None else float("inf")
        if shows:
            relay.screen = Screen(client, names, values, recording, relay.faults)
            relay.screen.run(end, stop)
        elif options.duration is not None or not (options.send or options.keep):
            relay.wait(client, recording, end, stop)
        if names and not relay.lost:
            client.stop_stream()
        recording.drain()
    return recording.stream


def _has_screen(options: argparse.Namespace) -> bool:
    from epg.live.keyboards import keyboard

    return keyboard().is_here() and not options.json and not options.keep


def _send(client: Client, lines: Iterable[str], stop: StopRequest, *, quiet: bool) -> None:
    """Sends the commands, and prints the answers unless ``quiet``."""
    from epg.live.enabling import send

    for line in lines:
        if stop.asked:
            break
        answer = send(client, line)
        if not quiet:
            print("\n".join(answer), flush=True)


def _hint_if_lost(port: Path) -> str:
    from epg.live.udp import is_udp

    if is_udp(port):
        return "look at the program and at the network, and connect again"
    return "the firmware needs the console on this port; reset the board, look at the cable; with a UART, check --baud"


def _open(options: argparse.Namespace) -> SerialPort | UdpPort:
    """The open port.  Asks for its key in a terminal.

    :raises PortError: it cannot be used
    """
    import getpass

    from epg.live.open import open_port
    from epg.live.udp import PortLocked
    from epg.live.udp_keys import keep_key

    while True:
        try:
            return open_port(options.port, options.baud)
        except PortLocked as problem:
            if not sys.stdin.isatty() or options.send == ["disable"]:
                raise
            sys.stderr.write(f"{problem}\n")
            try:
                typed = getpass.getpass("The key that its program has printed: ")
            except EOFError:
                raise problem from None
            keep_key(options.port, typed)


def _text_of(file: Path) -> str:
    """The text of a small file.

    :raises PortError: it cannot be read
    """
    from epg.live.port import PortError

    try:
        return file.read_text(encoding="ascii", errors="replace")
    except OSError as error:
        raise PortError(f"{file} cannot be read: {error.strerror}", "name the file with the key") from error


def _check_unattended(options: argparse.Namespace, diagnostics: Diagnostics) -> None:
    """Reports a line of --send that enables without a lease, and was not confirmed."""
    from epg.live.enabling import CONFIRM

    for line in options.send:
        if line.split() == ["enable", "unattended"] and not options.unattended:
            span = Span.of_argument(line, "--send")
            hint = "add --unattended to confirm this, or send 'enable'"
            diagnostics.error("unattended-not-confirmed", span, f"this is not on a lease: {CONFIRM}", hint=hint)


_DROPPED = """A replay is not possible over dropped rows.
hint: a larger 'capture' in 'communication' of the .tcf keeps more rows in memory
"""


def _bindings(file: Path, diagnostics: Diagnostics) -> str | None:
    """The text of bindings; None after a message if they have a mistake."""
    from epg.generator.documents.schema import load_schema, validate
    from epg.generator.documents.text_file import read_text
    from epg.generator.documents.yaml_file import parse_yaml

    text = read_text(file, diagnostics)
    root = parse_yaml(text, str(file), diagnostics) if text is not None else None
    return text if root is not None and validate(root, load_schema("bindings"), diagnostics) else None


def _keep(client: Client, options: argparse.Namespace, bindings: str) -> None:
    """Writes the changed parameters into the bindings, or says which ones there are.

    :raises Lost: the target does not answer
    """
    from epg.edit.parameters import set_parameters
    from epg.live.client import CommandRefused

    try:
        changed = {each.name: each.value for each in client.parameters() if each.value != each.generated}
    except CommandRefused:  # a target without parameters
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
        from epg.generator.data import targets_roots
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

    def wait(self, client: Client, recording: Recorder, end: float, stop: StopRequest) -> None:
        """Waits until ``stop``, until the connection is lost, or until the monotonic time ``end``."""
        while not stop.asked and not self.lost and time.monotonic() < end:
            while self._numbers:
                client.respond(self._numbers.pop(0))
            recording.drain()
            self._explain()
            time.sleep(0.02)

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
    from epg.live.client import CommandRefused
    from epg.live.replay_file import signals_to_record

    if options.record is not None:
        return signals_to_record(client.description)
    if options.signals is None:
        return [signal.name for signal in client.description.signals[:32]] if options.keep is None else []
    if options.signals == "none":
        return []
    names = [_signal(word, client.description) for word in options.signals.split(",")]
    if len(names) > 32:
        raise CommandRefused(f"a stream has at most 32 signals, not {len(names)}")
    return names


def _signal(word: str, description: TargetDescription) -> str:
    """The signal with the name ``word``, or with this name behind its first dot.

    :raises Refused: there is none, or there are several
    """
    from epg.generator.diagnostics import did_you_mean
    from epg.live.client import CommandRefused

    known = [signal.name for signal in description.streamed]
    signals = [name for name in known if word in (name, name.split(".", 1)[-1])]
    # A port of the model has precedence: its short name can also be that of an actuator or an encoder.
    ports = {signal.name for signal in description.signals}
    signals = [name for name in signals if name in ports] or signals
    if len(signals) != 1:
        problem = f"there is no signal '{word}'" if not signals else f"several signals have the name '{word}'"
        raise CommandRefused(f"{problem} ({did_you_mean(word, known, 'signals')})")
    return signals[0]


@contextlib.contextmanager
def _files(options: argparse.Namespace, client: Client, names: list[str]) -> Iterator[list[File]]:
    """The files of the command line, open."""
    from epg.generator import bootstrap
    from epg.live.replay_file import ReplayFile
    from epg.live.rows import Named
    from epg.runs.csv_file import CsvFile
    from epg.runs.mcap_file import McapRows

    if options.mcap is not None:
        bootstrap.ensure("mcap")
    topic = f"/{client.description.node or 'target'}"
    makers: list[tuple[Path | None, Callable[[], File]]] = [
        (options.csv, lambda: CsvFile(options.csv, names)),
        (options.mcap, lambda: McapRows(options.mcap, names, topic, time.time_ns())),
        (options.record, lambda: ReplayFile(options.record, client)),
    ]
    with contextlib.ExitStack() as stack:
        files: list[File] = []
        for path, make in makers:
            if path is not None:
                files.append(Named(path, make))
                stack.callback(files[-1].close)
        yield files


def _start(recording: Recorder, client: Client, names: list[str], options: argparse.Namespace) -> None:
    if not names:
        return
    known = [signal.name for signal in client.description.streamed]
    if options.record is not None and "enabled=1" in client.command("stats")[0].split(" "):
        sys.stderr.write("the target is enabled already: a replay begins at its next enabling\n")
    indices = [known.index(name) for name in names]
    every = recording.start(client, indices, options.every, exact=options.record is not None)
    if every != options.every and not options.json:
        sys.stderr.write(f"a row in every {every}th control cycle: the port carries no more\n")


def _list(options: argparse.Namespace, diagnostics: Diagnostics) -> int:
    from epg.cli.report import to_json
    from epg.cli.table import table
    from epg.generator.catalog.catalog import load_catalog
    from epg.generator.data import targets_roots
    from epg.live.found import look_at_all, ports

    found = look_at_all(ports(), load_catalog(targets_roots(user_roots()), diagnostics).usb_vendors())
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
