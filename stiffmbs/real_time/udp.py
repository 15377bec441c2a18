"""Inputs and outputs over UDP (RFC 768), with one other program, on the loopback interface unless more is allowed."""

from __future__ import annotations

import errno
import ipaddress
import socket
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from ..errors import InputError
from .exchange import Exchanged
from .parameters import REAL_TIME

NUMBER = np.dtype("<f8")


@dataclass(frozen=True)
class Packet:
    """Layout of a packet: a time, s, and the values of some names in their order, SI units."""

    names: tuple[str, ...]

    @property
    def size(self) -> int:
        """Return the length of a packet, bytes."""
        return NUMBER.itemsize * (1 + len(self.names))

    def empty(self) -> np.ndarray:
        """Return memory of a packet: the time and the values, of shape (1 + names,)."""
        return np.zeros(1 + len(self.names), NUMBER)

    def __str__(self) -> str:
        """Return the layout as a clause for messages."""
        return f"{self.size} bytes: {', '.join(('time', *self.names))}"


LARGEST_DATAGRAM: Final = 65507
"""Largest length of the content of a datagram over IPv4, bytes."""
LARGEST_PORT: Final = 65535
Address = tuple[Any, ...]
"""Address of a socket: host, port, and for IPv6 two numbers."""


@dataclass
class Ignored:
    """Ignored packets of a kind: a sentence on the first of them, and their number."""

    first: str
    count: int = 0


@dataclass
class Counts:
    """Numbers of packets so far; see `stiffmbs.real_time.exchange.Exchanged`."""

    received: int = 0
    sent: int = 0
    held: int = 0
    ignored: dict[str, Ignored] = field(default_factory=dict)

    def ignore(self, kind: str, sentence: str) -> None:
        """Count a packet that is ignored."""
        self.ignored.setdefault(kind, Ignored(sentence)).count += 1


class UdpExchange:
    """Socket that receives packets of inputs, and sends packets of outputs to the program that sent the first one.

    `address`: HOST:PORT; port 0 is any free port. `network`: allows a host that is not on the loopback interface.
    `in_turns`: every step waits for a packet. Otherwise a step takes the newest packet that has come. Raises InputError if
    the address is invalid, is not allowed or is in use.

    - `address`: HOST:PORT in use.
    """

    def __init__(
        self, address: str, inputs: Sequence[str], outputs: Sequence[str], in_turns: bool, network: bool
    ) -> None:
        self._in, self._out = Packet(tuple(inputs)), Packet(tuple(outputs))
        if self._out.size > LARGEST_DATAGRAM:
            raise InputError(
                f"udp: found {len(outputs)} outputs, expected at most {LARGEST_DATAGRAM // NUMBER.itemsize - 1}"
            )
        self._socket = _bound(address, network)
        host, port = self._socket.getsockname()[:2]
        self.address = f"[{host}]:{port}" if ":" in host else f"{host}:{port}"
        self._in_turns = in_turns
        self._client: Address | None = None
        self._received, self._taken, self._sent = bytearray(LARGEST_DATAGRAM + 1), self._in.empty(), self._out.empty()
        self._counts, self._first_taken, self._latest = Counts(), False, -np.inf

    def layouts(self) -> tuple[str, str]:
        """Return the layouts of packets of inputs and of outputs, as sentences."""
        return f"inputs: {self._in}", f"outputs: {self._out}"

    def wait(self) -> None:
        """Wait for the first packet, whose inputs are those of the first step, and whose sender gets the outputs."""
        self._socket.setblocking(True)
        while not self._take():
            pass
        self._first_taken = True
        self._socket.setblocking(self._in_turns)

    def receive(self) -> np.ndarray | None:
        """See `stiffmbs.real_time.exchange.Exchange`."""
        if self._first_taken:
            self._first_taken = False
            return self._taken[1:]
        if self._in_turns:
            while not self._take():
                pass
            return self._taken[1:]
        found = False
        for _ in range(REAL_TIME.packets):
            try:
                found = self._take() or found
            except BlockingIOError:
                break
        self._counts.held += not found
        return self._taken[1:] if found else None

    def _take(self) -> bool:
        """Read one packet; return False if it is ignored. Raises BlockingIOError if none has come."""
        try:
            length, sender = self._socket.recvfrom_into(self._received)
        except ConnectionError:  # Windows reports here that a packet of outputs did not arrive
            return False
        if length != self._in.size:
            self._counts.ignore("length", f"found {length} bytes, expected {self._in}")
            return False
        if self._client is not None and sender != self._client:
            self._counts.ignore("sender", f"found a packet from {sender[0]}:{sender[1]}, expected all from one sender")
            return False
        values = np.frombuffer(self._received, NUMBER, len(self._taken))
        if not np.isfinite(values).all():
            name = ("time", *self._in.names)[int(np.argmin(np.isfinite(values)))]
            self._counts.ignore("finite", f"found no finite number for '{name}', expected one")
            return False
        if values[0] < self._latest:
            self._counts.ignore(
                "order", f"found the time {values[0]:g} s after {self._latest:g} s, expected no earlier one"
            )
            return False
        self._client, self._latest = sender, float(values[0])
        self._taken[:] = values
        self._counts.received += 1
        return True

    def refuse(self, reason: str) -> None:
        """See `stiffmbs.real_time.exchange.Exchange`."""
        self._counts.received -= 1
        self._counts.ignore("value", reason)

    def send(self, t: float, values: np.ndarray) -> None:
        """See `stiffmbs.real_time.exchange.Exchange`."""
        self._sent[0], self._sent[1:] = t, values
        assert self._client is not None
        try:
            self._socket.sendto(self._sent.data, self._client)
        except OSError as error:
            self._counts.ignore("send", f"a packet of outputs could not be sent ({error.strerror})")
        else:
            self._counts.sent += 1

    def exchanged(self) -> Exchanged:
        """Return the numbers of packets so far."""
        counts = self._counts
        found = [(kind, each) for kind, each in counts.ignored.items()]
        reasons = tuple(
            f"{each.count} {'packet' if each.count == 1 else 'packets'} {'not sent' if kind == 'send' else 'ignored'}; "
            f"the first: {each.first}"
            for kind, each in found
        )
        ignored = sum(each.count for kind, each in found if kind != "send")
        return Exchanged(self.address, counts.received, counts.sent, ignored, reasons, counts.held)

    def close(self) -> None:
        """Close the socket."""
        self._socket.close()


def _bound(address: str, network: bool) -> socket.socket:
    """Return a socket that is bound to an address."""
    host, _, port = address.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    if not host or not (port.isascii() and port.isdigit() and int(port) <= LARGEST_PORT):
        raise InputError(
            f"udp: found '{address}', expected HOST:PORT with a port of 0 to {LARGEST_PORT}, such as 127.0.0.1:5005"
        )
    try:
        family, kind, protocol, _, place = socket.getaddrinfo(host, int(port), type=socket.SOCK_DGRAM)[0]
    except (OSError, UnicodeError):
        raise InputError(f"udp: found no host '{host}', expected one such as 127.0.0.1 or localhost") from None
    if not (network or ipaddress.ip_address(str(place[0]).partition("%")[0]).is_loopback):
        raise InputError(
            f"udp: found '{host}', which other computers can reach, expected a loopback address such as 127.0.0.1; "
            "--network allows it, and packets are then accepted from any computer"
        )
    made = socket.socket(family, kind, protocol)
    try:
        made.bind(place)
    except OSError as error:
        made.close()
        in_use = error.errno == errno.EADDRINUSE
        reason = "the port is in use" if in_use else f"the address cannot be used ({error.strerror})"
        raise InputError(f"udp: {address}: {reason}; choose another one, or port 0 for any free port") from None
    return made
