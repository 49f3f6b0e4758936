#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how long a Float64 on /ping takes to come back on /pong, as a plain DDS participant: no ROS 2 needed.

    python measure.py --rate 30 --count 900                     a ping every 33 ms, as setpoints come
    python measure.py --rate 0 --count 10000 --csv run.csv      the next ping as soon as the pong is there
    python measure.py --baseline                                against an echo in Python: what DDS and Python take

A time begins before the ping is handed to DDS and ends when the pong is in this program's hands: it includes this
program's own work (see --baseline).  Each ping carries its number, so that a late pong is not taken for another one's.
A ping that is not answered within --patience is lost; at a fixed rate pings go out whether the one before came back or
not.

The QoS options are those of the target: a best-effort subscriber gets best-effort pings, and a best-effort publisher is
read at best effort.  Needs the packages cyclonedds and, for --png, matplotlib.
"""

from __future__ import annotations

import argparse
import gc
import subprocess
import sys
import time
from pathlib import Path

try:
    from dds import Endpoint
except ImportError as error:
    sys.exit(f"{error}: pip install cyclonedds")

import histogram
from summary import Run, summarise, table, write_run

QOS = ("reliable", "best_effort")


def measure(endpoint: Endpoint, *, rate: float, count: int, patience: float, label: str, first: int = 0) -> Run:
    """``count`` round trips; ``rate`` in Hz, 0 for as fast as answers come; ``patience`` in s.

    ``first`` is the first ping's number: no pong of an earlier measurement is taken for one of this.
    """
    sent: dict[int, int] = {}
    times: list[float] = []
    begin = time.perf_counter_ns()
    gc.collect()
    gc.disable()  # a pause of the collector would be taken for one of the target
    try:
        for number in range(first, first + count):
            if rate > 0.0:
                _collect(endpoint, sent, times, begin + int(1e9 * (number - first) / rate), until_answered=None)
            sent[number] = time.perf_counter_ns()
            endpoint.write(float(number))
            if rate == 0.0:
                _collect(endpoint, sent, times, time.perf_counter_ns() + int(1e9 * patience), until_answered=number)
        _collect(endpoint, sent, times, time.perf_counter_ns() + int(1e9 * patience), until_answered=-1)
    finally:
        gc.enable()
    return Run(label, times, count - len(times))


def _collect(
    endpoint: Endpoint, sent: dict[int, int], times: list[float], deadline: int, *, until_answered: int | None
) -> None:
    """Takes pongs until ``deadline``, or until ping ``until_answered`` (-1: every one) has come back."""
    while True:
        if until_answered is not None and (until_answered not in sent if until_answered >= 0 else not sent):
            return
        rest = deadline - time.perf_counter_ns()
        if rest <= 0:
            return
        for value in endpoint.take(1e-9 * rest):
            now = time.perf_counter_ns()
            begun = sent.pop(int(value), None)
            if begun is not None:
                times.append(1e-9 * (now - begun))


def echo(endpoint: Endpoint) -> None:
    """Answers every ping, until the process is ended."""
    while True:
        for value in endpoint.take(1.0):
            endpoint.write(value)


def main() -> int:
    options = _arguments()
    names = (f"{options.namespace}/ping", f"{options.namespace}/pong")
    if options.echo:
        reliable = (options.publisher == "reliable", options.subscriber == "reliable")
        echo(Endpoint(options.domain, names[1], names[0], write_reliable=reliable[0], read_reliable=reliable[1]))
    answering = _start_echo(options) if options.baseline else None
    try:
        endpoint = Endpoint(
            options.domain,
            *names,
            write_reliable=options.subscriber == "reliable",
            read_reliable=options.publisher == "reliable",
        )
        missing = endpoint.wait_for_peer(options.wait)
        if missing:
            print(f"measure.py: within {options.wait:g} s there was {missing}", file=sys.stderr)
            return 1
        measure(endpoint, rate=0.0, count=options.warm_up, patience=options.patience, label="")
        run = measure(
            endpoint,
            rate=options.rate,
            count=options.count,
            patience=options.patience,
            label=_label(options),
            first=options.warm_up,
        )
    finally:
        if answering is not None:
            answering.terminate()
            answering.wait()
    print(table([summarise(run)]))
    print(f"\n{histogram.text(run.times)}")
    if options.csv:
        write_run(run, options.csv)
    if options.png:
        histogram.draw([(run.label, run.times)], options.png)
    return 0 if run.times else 1


def _start_echo(options: argparse.Namespace) -> subprocess.Popen[bytes]:
    command = [sys.executable, __file__, "--echo", "--domain", str(options.domain), "--namespace", options.namespace]
    return subprocess.Popen([*command, "--publisher", options.publisher, "--subscriber", options.subscriber])


def _label(options: argparse.Namespace) -> str:
    rate = f"{options.rate:g} Hz" if options.rate > 0.0 else "flat out"
    who = options.label or ("baseline" if options.baseline else "target")
    return f"{who}, {_short(options.publisher)}/{_short(options.subscriber)}, {rate}"


def _short(qos: str) -> str:
    return "best" if qos == "best_effort" else "default"


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False
    )
    parser.add_argument("--rate", type=float, default=30.0, metavar="HZ", help="0: flat out; default: 30")
    parser.add_argument("--count", type=int, default=900, help="pings; default: 900")
    parser.add_argument("--warm-up", type=int, default=20, help="pings before that are not counted; default: 20")
    parser.add_argument("--publisher", choices=QOS, default="reliable", help="QoS of the target's /pong")
    parser.add_argument("--subscriber", choices=QOS, default="reliable", help="QoS of the target's /ping")
    parser.add_argument("--namespace", default="", help="of the target, such as /robot1")
    parser.add_argument("--domain", type=int, default=_domain(), help="default: ROS_DOMAIN_ID, else 0")
    parser.add_argument("--patience", type=float, default=1.0, metavar="S", help="until a ping is lost; default: 1")
    parser.add_argument("--wait", type=float, default=30.0, metavar="S", help="for the target; default: 30")
    parser.add_argument("--label", default="", help="name of the target in the table")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write the times, for summary.py")
    parser.add_argument("--png", type=Path, metavar="FILE", help="draw the histogram")
    parser.add_argument("--baseline", action="store_true", help="start an echo in Python and measure that")
    parser.add_argument("--echo", action="store_true", help="be that echo")
    return parser.parse_args()


def _domain() -> int:
    import os

    text = os.environ.get("ROS_DOMAIN_ID", "")
    return int(text) if text.isdigit() else 0


if __name__ == "__main__":
    sys.exit(main())
