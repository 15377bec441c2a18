"""Decisions on steps in real time: waiting, packets, steps before the first one."""

from __future__ import annotations

from unittest.mock import patch

import numpy as np

from stiffmbs.real_time import loop, udp
from tests.decisions.common import Record, nothing, reach, reached


def time_of_polling():
    """Return the time before a step is due at which a sleep ends, s."""
    with patch.object(loop, "time", Record(perf_counter_ns=nothing, sleep=reach)):
        return 1.0 - reached(lambda: loop._wait_until(10**9))


def packets_of_a_flood():
    """Return the number of packets that are read before a step."""
    taken = []
    exchange = Record(
        _first_taken=False, _in_turns=False, _take=lambda: taken.append(0) or True, _counts=Record(held=0), _taken=np.zeros(2)
    )  # fmt: skip
    udp.UdpExchange.receive(exchange)
    return len(taken)


def steps_before_the_first_one():
    """Return the number of steps that load code."""
    taken = []
    loop.warm_up(
        Record(step=taken.append, warm_up=nothing, reset=nothing), loop.Loop(dt=1.0, steps=1, channels=(), paced=False)
    )
    return len(taken)


DECISIONS = {
    "real_time.polled": time_of_polling,
    "real_time.packets": packets_of_a_flood,
    "real_time.warming": steps_before_the_first_one,
}
EXPECTED = {"real_time.polled": 2e-4, "real_time.packets": 100, "real_time.warming": 10}
