# SPDX-License-Identifier: Apache-2.0
"""The agent: a thread that serves a link, and the faults that tests cause."""

from __future__ import annotations

import heapq
import itertools
import os
import random
import select
import struct
import threading
import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass

from .client import Client
from .faults import Faults
from .links import Link
from .log import Log
from .representations import Description, read_description
from .topics import Topics
from .wire import (
    AGENT_ID,
    CLIENT_ID,
    COOKIE,
    SUBHEADER,
    VENDOR,
    VERSION,
    WITHOUT_KEY,
    CdrReader,
    Header,
    Id,
    Kind,
    Status,
    Submessage,
    WireError,
    split,
    submessage,
    submessages,
)

AGENT_INFO = COOKIE + VERSION + VENDOR + b"\0"
MOST_QUESTIONS = 3
"""How often the agent asks a silent client before it removes the client's entities."""


@dataclass
class Refusal:
    """CREATE requests that the agent answers with an error instead of creating the entity."""

    status: Status
    kind: Kind | None = None
    """The kind of entity; None: any kind."""
    name: str = ""
    """A part of the name of the participant or topic."""
    times: int = 1_000_000
    """The number of refusals; later requests succeed."""

    def meets(self, kind: Kind, name: str) -> bool:
        return self.times > 0 and self.kind in (None, kind) and self.name in name


class Agent:
    """Serves ``link`` in its own thread.

    Behaves like eProsima's agent wherever a board can detect a difference.  A client that connects again with its old
    key keeps its entities and its readers: their samples arrive while the client creates them again.  An agent that was
    restarted answers pings of clients that it does not know.
    """

    def __init__(
        self,
        link: Link,
        topics: Topics | None = None,
        seed: int = 1,
        heartbeat: float = 0.2,
        clock: Callable[[], float] = time.monotonic,  # the agent's timebase; a simulation gives its own
    ) -> None:
        """``clock`` returns seconds: those of a simulation if nothing may wait for real time."""
        self.link = link
        self._clock = clock
        self.topics = topics if topics is not None else Topics()
        self.lock = self.topics.lock  # one lock for all: a sample passes from board to board in one step
        self.to_board, self.from_board = Faults(), Faults()
        self.refusals: list[Refusal] = []
        self.clients: dict[bytes, Client] = {}
        self.created: list[tuple[float, bytes]] = []
        """Every connection since the start: its time and its client."""
        self.mute: set[Id] = set()
        """Submessages that the agent does not answer."""
        self.mute_streams: set[int] = set()
        """Streams whose frames from the boards are lost."""
        self.clock_offset = 0.0
        """Seconds by which the agent's clock is ahead."""
        self.log = Log()
        self.malformed = 0
        self._peers: dict[Hashable, bytes] = {}
        self._heartbeat = heartbeat
        self._chance = random.Random(seed)
        self._later: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = itertools.count()
        self._frozen = False
        self._alive = False
        self._wake_read, self._wake_write = os.pipe()
        os.set_blocking(self._wake_read, False)
        self._ending = False
        self._thread = threading.Thread(target=self._run, daemon=True, name="xrce agent")
        self._thread.start()
        self.start()

    # Faults that tests cause ----------------------------------------------------------------------------------------

    @property
    def address(self) -> str:
        """ "127.0.0.1:8888", or the path of a terminal."""
        return str(self.link.address)  # type: ignore[attr-defined]

    def start(self) -> None:
        with self.lock:
            self.link.open()
            self._alive = True
            self._wake()

    def kill(self) -> None:
        """Ends like a killed process: it informs no client, keeps no data, and its entities leave the topics."""
        with self.lock:
            self._alive = False
            self.link.close()
            for client in self.clients.values():
                client.delete_all()
            self.clients.clear()
            self._peers.clear()
            self._later.clear()
            self._wake()

    def restart(self, pause: float = 0.0) -> None:
        self.kill()
        time.sleep(pause)  # the agent is absent
        self.start()

    def freeze(self) -> None:
        """Stops like a suspended process: bytes that arrive wait in the system's buffer."""
        with self.lock:
            self._frozen = True

    def thaw(self) -> None:
        self._frozen = False
        self._wake()

    def inject(self, data: bytes, raw: bool = False) -> None:
        """Sends ``data`` to every peer as if it were a message; ``raw``: as bytes of the line, without a frame."""
        with self.lock:
            for peer in self._peers:
                self.log.add(False, peer, data, "injected")
                self.link.send_raw(peer, data if raw else self.link.raw(peer, data))

    def say(self, stream: int, content: bytes) -> None:
        """Sends the submessage ``content`` to every client on a stream of its session, correctly numbered."""
        with self.lock:
            for client in self.clients.values():
                for message in client.push(stream, content) or []:
                    self._send(client.peer, message)

    def refuse(self, status: Status, kind: Kind | None = None, name: str = "", times: int = 1_000_000) -> None:
        self.refusals.append(Refusal(status, kind, name, times))

    def wait_until(self, condition: Callable[[], bool], seconds: float = 20.0) -> None:
        assert self.topics.wait_until(condition, seconds), f"not within {seconds} s; log:\n{self.tail()}"

    def tail(self, count: int = 30) -> str:
        return "\n".join(str(frame) for frame in list(self.log)[-count:])

    def close(self) -> None:
        self.kill()
        self._ending = True
        self._wake()
        self._thread.join()
        os.close(self._wake_read)
        os.close(self._wake_write)

    def __enter__(self) -> Agent:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # The thread ------------------------------------------------------------------------------------------------------

    def _wake(self) -> None:
        os.write(self._wake_write, b"x")

    def _run(self) -> None:
        next_beat = 0.0
        while not self._ending:
            now = time.monotonic()  # the agent's heartbeat
            with self.lock:
                file = self.link.fileno() if self._alive and not self._frozen else -1
                due = self._later[0][0] if self._later else next_beat
            files = [self._wake_read] + ([file] if file >= 0 else [])
            wait = max(0.0, min(due, next_beat, now + 0.05) - now)
            try:
                ready = select.select(files, [], [], wait)[0]
            except (OSError, ValueError):  # the link was closed meanwhile
                continue
            if self._wake_read in ready:
                os.read(self._wake_read, 4096)
            with self.lock:
                if self._alive and not self._frozen:
                    if file in ready and file == self.link.fileno():
                        self._receive()
                    self._run_later()
                    if now >= next_beat:
                        next_beat = now + self._heartbeat
                        self.link.open()  # the device has come back
                        self._beat()

    def _run_later(self) -> None:
        while self._later and self._later[0][0] <= self._clock():
            heapq.heappop(self._later)[2]()

    def _after(self, seconds: float, action: Callable[[], None]) -> None:
        if seconds <= 0:
            action()
        else:
            heapq.heappush(self._later, (self._clock() + seconds, next(self._numbers), action))
            self._wake()

    def _receive(self) -> None:
        for peer, data in self.link.receive():
            arrivals = self.from_board.arrivals(self._chance)
            frame = self.from_board.damage(data, self._chance)
            if frame != data and self.link.checked:
                arrivals = []
            self.log.add(True, peer, data, "" if arrivals else "lost")
            for wait in arrivals:
                self._after(wait, lambda peer=peer, frame=frame: self._handle_frame(peer, frame))  # type: ignore[misc]

    def _send(self, peer: Hashable, data: bytes) -> None:
        arrivals = self.to_board.arrivals(self._chance)
        self.log.add(False, peer, data, "" if arrivals else "lost")
        for wait in arrivals:
            self._after(
                wait, lambda: self.link.send_raw(peer, self.to_board.damage(self.link.raw(peer, data), self._chance))
            )

    def _beat(self) -> None:
        for client in [client for client in self.clients.values() if client.dead_after is not None]:
            self._check_alive(client, client.dead_after or 0.0)
        for client in self.clients.values():
            for beat in client.heartbeats():
                self._reply(client, beat)
            self._pump(client)

    def _check_alive(self, client: Client, dead_after: float) -> None:
        """Source: ``Processor::check_heartbeats`` of eProsima's agent (hard liveliness)."""
        if self._clock() - client.heard < dead_after:
            return
        if client.asked == MOST_QUESTIONS:
            self._forget(client.key)
            return
        client.asked += 1
        self._reply(client, submessage(Id.GET_INFO, b"\0\0" + CLIENT_ID + bytes(4)))

    # Messages --------------------------------------------------------------------------------------------------------

    def _handle_frame(self, peer: Hashable, frame: bytes) -> None:
        try:
            header, body = split(frame)
            if header.session in (0x00, WITHOUT_KEY):
                self._outside(peer, header, body)
                return
            key = header.key if header.session < WITHOUT_KEY else self._peers.get(peer, b"")
            client = self.clients.get(key)  # also with another session number, as in eProsima's agent
            if client is None:
                self._stranger(peer, header, body)
                return
            client.heard, client.asked = self._clock(), 0
            if header.stream in self.mute_streams:
                return
            for whole in client.receive(header.stream, header.sequence, body):
                self._handle_all(client, header.stream, whole)
            if header.stream >= 0x80:
                self._reply(client, client.reliable_input(header.stream).acknack(header.stream))
        except WireError:
            self.malformed += 1

    def _outside(self, peer: Hashable, header: Header, body: bytes) -> None:
        """Handles a message outside any session."""
        for part in submessages(body):
            if part.id in self.mute:
                continue
            if part.id == Id.CREATE_CLIENT:
                # eProsima's client gives a length without the properties, and its agent does not read the length.
                self._create_client(peer, header, Submessage(part.id, part.flags, body[SUBHEADER:]))
                return
            if part.id == Id.GET_INFO:
                self._send(peer, header.pack() + self._info(part, peer in self._peers))

    def _stranger(self, peer: Hashable, header: Header, body: bytes) -> None:
        """Handles a message of a session that this agent does not know: the session began before the agent's start."""
        for part in itertools.islice(submessages(body), 1):
            if part.id == Id.GET_INFO and Id.GET_INFO not in self.mute:
                self._send(peer, header.pack() + self._info(part, False))
            elif part.id == Id.DELETE and part.payload[2:4] == CLIENT_ID:
                self._send(peer, header.pack() + submessage(Id.STATUS, part.payload[:4] + bytes([Status.OK, 0])))

    def _create_client(self, peer: Hashable, header: Header, part: Submessage) -> None:
        reader = part.reader
        cookie, version, _vendor = reader.take(4), reader.take(2), reader.take(2)
        key, session = reader.take(4), reader.u8()
        properties = {}
        if reader.flag():
            properties = {reader.string(): reader.string() for _ in range(reader.u32())}
        mtu = reader.u16()
        status = Status.OK
        if cookie != COOKIE or key == bytes(4):
            status = Status.INVALID_DATA
        elif version[:1] != VERSION[:1]:
            status = Status.INCOMPATIBLE
        if status == Status.OK:
            client = self._connect(peer, key, session, mtu)
            client.dead_after = int(properties["uxr_hl"]) / 1000 if "uxr_hl" in properties else None
            client.heard, client.asked = self._clock(), 0
        reply = Header(session, 0, 0, key).pack()
        self._send(peer, reply + submessage(Id.STATUS_AGENT, bytes([status, 0]) + AGENT_INFO))

    def _connect(self, peer: Hashable, key: bytes, session: int, mtu: int) -> Client:
        before = self._peers.get(peer)
        if before is not None and before != key:
            self._forget(before)
        client = self.clients.get(key)
        if client is not None and client.session == session:
            self._peers = {p: k for p, k in self._peers.items() if k != key}
            client.peer, client.mtu = peer, mtu
            client.reset_streams()
        else:
            self._forget(key)
            client = Client(key, session, mtu, peer, self.topics)
            client.pump = self._pump
            self.clients[key] = client
        self._peers[peer] = key
        self.created.append((self._clock(), key))
        return client

    def _forget(self, key: bytes) -> None:
        client = self.clients.pop(key, None)
        if client is not None:
            client.delete_all()
            self._peers = {p: k for p, k in self._peers.items() if k != key}

    def _info(self, part: Submessage, known: bool) -> bytes:
        """The answer to a ping; ``known``: a session exists."""
        variant = b"\x01\x0d" + AGENT_INFO
        activity = b"\x01\x0d\0" + struct.pack("<hxxI", 1, 0)  # available; no addresses
        return submessage(Id.INFO, part.payload[:4] + bytes([Status.OK, known]) + variant + activity)

    def _handle_all(self, client: Client, stream: int, body: bytes) -> None:
        for part in submessages(body):
            if part.id in self.mute:
                continue
            if part.id == Id.FRAGMENT:
                whole = client.fragments(stream).add(part)
                if whole is not None:
                    self._handle_all(client, stream, whole)
            else:
                self._handle(client, stream, part)

    def _handle(self, client: Client, stream: int, part: Submessage) -> None:
        reader = part.reader
        if part.id == Id.CREATE:
            self._create(client, stream, part.flags, reader)
        elif part.id == Id.DELETE:
            self._delete(client, stream, reader.take(4))
        elif part.id == Id.WRITE_DATA and not part.flags & 0x0E:
            request = reader.take(4)
            client.write(request[2:], reader.rest())
        elif part.id == Id.READ_DATA:
            status = client.read(part)
            if status != Status.OK:
                self._status(client, 0x80, reader.take(4), status)
        elif part.id == Id.ACKNACK:
            first, missing, which = reader.u16(), int.from_bytes(reader.take(2), "big"), reader.u8()
            for message in client.reliable_output(which).acknack(first, missing):
                self._send(client.peer, message)
            self._pump(client)
        elif part.id == Id.HEARTBEAT:
            first, last, which = reader.u16(), reader.u16(), reader.u8()
            for whole in client.reliable_input(which).heartbeat(first, last):
                self._handle_all(client, which, whole)
            self._reply(client, client.reliable_input(which).acknack(which))
        elif part.id == Id.GET_INFO:
            self._reply(client, self._info(part, True))
        elif part.id == Id.RESET:
            client.reset_streams()
        elif part.id == Id.TIMESTAMP:
            self._reply(client, submessage(Id.TIMESTAMP_REPLY, self._now() * 2 + reader.take(8)))

    def _now(self) -> bytes:
        now = time.time_ns() + int(self.clock_offset * 1e9)  # the agent's clock, which boards ask for
        return struct.pack("<iI", now // 10**9, now % 10**9)

    def _create(self, client: Client, stream: int, flags: int, reader: CdrReader) -> None:
        request = reader.take(4)
        new = read_description(reader)
        named: Description = client.objects.get(new.topic, new) if new.topic else new
        for refusal in self.refusals:
            if refusal.meets(new.kind, named.name):
                refusal.times -= 1
                self._status(client, stream, request, refusal.status)
                return
        self._status(client, stream, request, client.create(request[2:], new, flags))

    def _delete(self, client: Client, stream: int, request: bytes) -> None:
        if request[2:] == CLIENT_ID:
            self._forget(client.key)
            self._reply(client, submessage(Id.STATUS, request + bytes([Status.OK, 0])))
        else:
            self._status(client, stream, request, client.delete(request[2:]))

    def _status(self, client: Client, stream: int, request: bytes, status: Status) -> None:
        answer = submessage(Id.STATUS, request + bytes([status, 0]))
        for message in client.push(0x80 if stream >= 0x80 else 0x01, answer) or []:
            self._send(client.peer, message)

    def _reply(self, client: Client, content: bytes) -> None:
        """Sends a reply on no stream."""
        self._send(client.peer, Header(client.session, 0, 0, client.key).pack() + content)

    def _pump(self, client: Client) -> None:
        if self._alive and not self._frozen:
            for message in client.next_data():
                self._send(client.peer, message)


__all__ = ["AGENT_ID", "Agent", "Refusal"]
