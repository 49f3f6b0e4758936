# SPDX-License-Identifier: Apache-2.0
"""A bad network: a program that passes datagrams on between clients and a target, and harms them in both directions.

    python -m tests.doubles.network.relay TARGET_PORT LOSS COPIES

It prints the port that it listens on.  It loses LOSS of the datagrams, and sends COPIES of them a second time, half of
these as late as 0.6 s later.  Each datagram is delayed by up to 10 ms, so that they overtake each other.
"""

from __future__ import annotations

import heapq
import itertools
import random
import select
import socket
import sys
import time

HERE = "127.0.0.1"
LATE = 0.6
DELAY = 0.01


def main(target: int, loss: float, copies: float) -> None:
    chance = random.Random(20)
    front = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    front.bind((HERE, 0))
    print(front.getsockname()[1], flush=True)
    backs: dict[tuple[str, int], socket.socket] = {}
    clients: dict[socket.socket, tuple[str, int]] = {}
    order = itertools.count()
    due: list[tuple[float, int, socket.socket, tuple[str, int] | None, bytes]] = []

    def pass_on(sender: socket.socket, address: tuple[str, int] | None, data: bytes) -> None:
        if chance.random() >= loss:
            heapq.heappush(due, (now + chance.uniform(0, DELAY), next(order), sender, address, data))
        if chance.random() < copies:
            late = chance.choice((chance.uniform(0, DELAY), LATE))
            heapq.heappush(due, (now + late, next(order), sender, address, data))

    now = 0.0
    while True:
        wait = max(0.0, due[0][0] - now) if due else None
        found = select.select([front, *clients], [], [], wait)[0]
        now = time.monotonic()  # the delay of the network
        for ready in found:
            try:
                data, address = ready.recvfrom(65536)
            except ConnectionRefusedError:
                continue
            if ready is not front:
                pass_on(front, clients[ready], data)
                continue
            if address not in backs:
                back = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                back.connect((HERE, target))
                backs[address], clients[back] = back, address
            pass_on(backs[address], None, data)
        while due and due[0][0] <= now:
            _, _, sender, address, data = heapq.heappop(due)
            try:
                sender.sendto(data, address) if address is not None else sender.send(data)
            except ConnectionRefusedError:
                continue


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3]))
