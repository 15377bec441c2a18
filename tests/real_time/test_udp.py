"""Inputs and outputs over UDP on the loopback interface."""

import socket
import struct
import threading
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.real_time import udp
from stiffmbs.real_time.udp import UdpExchange
from stiffmbs.solve.trajectory import Outcome

from .scenes import driven

WITHIN = 20.0
"""Time after which a test gives up, s."""


class Running:
    """Steps in a thread, and a client of them."""

    def __init__(self, **settings):
        self._ready, self.found = threading.Event(), None
        self._thread = threading.Thread(target=self._run, args=(settings,), daemon=True)
        self.client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.client.settimeout(WITHIN)

    def _run(self, settings):
        self.found = stiffmbs.realtime(driven(), udp="127.0.0.1:0", tell=self._tell, **settings)

    def _tell(self, sentence):
        if "waiting" in sentence:
            self._port = int(sentence.rpartition(":")[2])
            self._ready.set()

    def __enter__(self):
        self._thread.start()
        assert self._ready.wait(WITHIN)
        return self

    def __exit__(self, *_):
        self._thread.join(WITHIN)
        self.client.close()

    def send(self, *values):
        self.client.sendto(struct.pack(f"<{len(values)}d", *values), ("127.0.0.1", self._port))

    def receive(self, count):
        return struct.unpack(f"<{count}d", self.client.recv(1000))


def test_each_packet_is_a_step_with_its_inputs():
    forces, outputs = np.linspace(-1.0, 2.0, 20), []
    with Running(step=1e-2, paced=False, channels=["cart.x", "rail.fy"]) as running:
        for k, force in enumerate(forces):
            running.send(k * 1e-2, force)
            outputs.append(running.receive(3))
    found = running.found
    assert (found.outcome, found.steps) == (Outcome.DONE, 20)
    assert (found.exchanged.received, found.exchanged.sent, found.exchanged.ignored) == (20, 20, 0)
    sim = stiffmbs.simulation(driven(), solver="projected", scheme="extrapolated_euler", step=1e-2)
    for force, (t, x, fy) in zip(forces, outputs, strict=True):
        sim.step(1e-2, [force])
        assert (t, x, fy) == (sim.t, sim["cart.x"], sim["rail.fy"])
    assert "inputs came over UDP" in found.accuracy.message
    assert found.solution is None


def test_paced_steps_hold_the_last_inputs():
    with Running(step=1e-2, channels=["cart.vx"]) as running:
        running.send(0.0, 3.0)
        outputs = [running.receive(2) for _ in range(20)]
    sim = stiffmbs.simulation(driven(), solver="projected", scheme="extrapolated_euler", step=1e-2)
    sim.steps(20, [3.0])
    assert outputs[-1] == (sim.t, sim["cart.vx"])
    assert running.found.exchanged.held == 19
    assert "19 steps without a new packet" in str(running.found)


def test_wrong_packets_are_ignored_and_reported():
    other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with other, Running(step=1e-1, paced=False) as running:
        running.send(1.0)
        running.send(1.0, 2.0, 3.0)
        running.send(1.0, np.nan)
        running.send(1.0, 2.0)
        running.receive(4)
        running.send(0.5, 2.0)
        other.sendto(struct.pack("<2d", 2.0, 9.0), ("127.0.0.1", running._port))
        running.send(2.0, 4.0)
        running.receive(4)
    found = running.found.exchanged
    assert (found.received, found.ignored) == (2, 5)
    reported = "\n".join(found.reasons)
    assert "2 packets ignored; the first: found 8 bytes, expected 16 bytes: time, F" in reported
    assert "found no finite number for 'F'" in reported
    assert "found the time 0.5 s after 1 s" in reported
    assert "expected all from one sender" in reported


def test_inputs_that_a_scene_refuses_are_ignored_and_reported():
    with Running(step=1e-1, paced=False, inputs={"c": 0.5}) as running:
        for values in ((0.0, 0.5, 1.0), (0.0, 1e300, 1.0)):
            running.send(*values)
            running.receive(4)
    found = running.found.exchanged
    assert (found.received, found.ignored) == (1, 1)
    assert "'c'" in found.reasons[0]


def test_outputs_are_by_default_the_positions_of_bodies():
    with Running(step=1e-1, paced=False) as running:
        for _ in range(2):
            running.send(0.0, 1.0)
            assert len(running.receive(4)) == 4
    assert running.found.channels == ("cart.x", "cart.y", "cart.angle")


def test_outputs_are_by_default_the_requests_of_a_scene():
    scene = stiffmbs.read_scene(
        "{bodies: {a: {mass: 1, inertia: 1}}, requests: {twice: 2*dx(a)}, run: {duration: 0.1}}"
    )
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:

        def tell(sentence):
            if "waiting" in sentence:
                client.sendto(struct.pack("<d", 0.0), ("127.0.0.1", int(sentence.rpartition(":")[2])))

        found = stiffmbs.realtime(scene, step=0.05, udp="127.0.0.1:0", tell=tell)
    assert found.channels == ("twice",)


def test_a_flood_of_packets_does_not_stop_the_steps():
    exchange = UdpExchange("127.0.0.1:0", ["F"], ["x"], in_turns=False, network=False)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        place = ("127.0.0.1", int(exchange.address.rpartition(":")[2]))
        for k in range(150):
            client.sendto(struct.pack("<2d", k, k), place)
        exchange.wait()
        assert exchange.receive().tolist() == [0.0]
        assert exchange.receive().tolist() == [udp.REAL_TIME.packets]
        assert exchange.receive().tolist() == [149.0]
        assert exchange.receive() is None
    exchange.close()


@pytest.mark.parametrize(
    ("address", "message"),
    [
        ("127.0.0.1", "expected HOST:PORT"),
        ("127.0.0.1:http", "expected HOST:PORT"),
        ("127.0.0.1:70000", "a port of 0 to 65535"),
        ("0.0.0.0:0", "other computers can reach"),
        ("[::]:0", "other computers can reach"),
        ("192.0.2.1:5005", "other computers can reach"),
        ("host.invalid:5005", "no host 'host.invalid'"),
    ],
)
def test_an_address_that_is_not_on_this_computer_is_refused(address, message):
    with pytest.raises(InputError, match=message):
        UdpExchange(address, [], [], in_turns=False, network=False)


def test_the_network_is_used_if_it_is_allowed():
    UdpExchange("0.0.0.0:0", [], [], in_turns=False, network=True).close()


def test_a_port_in_use_is_refused():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", 0))
        with pytest.raises(InputError, match="the port is in use; choose another one"):
            stiffmbs.realtime(driven(), step=1e-2, udp=f"127.0.0.1:{other.getsockname()[1]}")


def test_outputs_must_fit_into_a_datagram():
    with pytest.raises(InputError, match="found 9000 outputs, expected at most 8187"):
        UdpExchange("127.0.0.1:0", [], ["x"] * 9000, in_turns=False, network=False)


def test_the_client_of_the_guide_pushes_the_cart(monkeypatch):
    text = (Path(stiffmbs.__file__).parents[1] / "docs" / "guide" / "studies.md").read_text(encoding="utf-8")
    guide = text.partition("### Inputs and outputs over UDP")[2]
    scene = guide.partition("# cart.yaml\n")[2].partition("```")[0]
    client = guide.partition("```{code-block} python\n")[2].partition("```")[0]
    names, threads = {}, []

    def tell(sentence):
        if "waiting" in sentence:
            code = client.replace("5005", sentence.rpartition(":")[2])
            threads.append(threading.Thread(target=exec, args=(code, names), daemon=True))
            threads[0].start()

    found = stiffmbs.realtime(
        stiffmbs.read_scene(scene), step=1e-3, udp="127.0.0.1:0", channels=["cart.x", "cart.vx"], paced=False, tell=tell
    )
    threads[0].join(WITHIN)
    assert (found.steps, found.exchanged.ignored) == (2000, 0)
    assert names["t"] == pytest.approx(2.0)
    assert names["speed"] == pytest.approx(1 - np.exp(-10), abs=1e-3)
