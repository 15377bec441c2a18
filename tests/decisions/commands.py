"""Decisions on commands, live pages and robots: limits of requests and pages, progress, interrupts, turns of joints."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from unittest.mock import patch

import numpy as np

from stiffmbs.commands import process, progress
from stiffmbs.live import app, page, requests, worker, workers
from stiffmbs.reading.units.display import SI_UNITS
from stiffmbs.robots.mjcf import model as mjcf
from stiffmbs.robots.robot import RobotFault
from stiffmbs.robots.scene import mechanism
from stiffmbs.robots.sdf import files, gears
from stiffmbs.solve.trajectory import Outcome
from tests.decisions.common import BELOW, Reached, Record, nothing, reach, reached
from tests.solve.test_parameter_thresholds import DOUBLES, count_while


def largest_request():
    def accepts(length):
        heads = [(b"host", b"h"), (b"content-length", str(length).encode())]
        scope = {"headers": heads, "method": "GET", "path": "/t/"}
        return app.Guard._refusal(Record(_hosts={"h"}, _token="t"), scope) is None

    return count_while(lambda length: accepts(round(1e4 * length)), DOUBLES)


def height_of_a_frame():
    return int(re.search(r'height="(\d+)"', page.LivePage._repr_html_(Record(url=""))).group(1))


def most_cases():
    request = Record(rest={}, number=lambda _name, _least, most: reach(most))
    return reached(lambda: requests._sweep(request))


def instants_of_a_band():
    found = Record(outcome=Outcome.DONE, time=np.arange(5000.0), channels={}, display=SI_UNITS)
    solved = Record(solution=found)
    request = Record(
        rest={}, number=lambda *_: 2.0, numbers={}, names=lambda _: (), tell=nothing, solved=lambda _: solved
    )
    return len(requests._sweep(request)["time"])


def pause_before_the_end():
    with patch.object(worker, "time", Record(sleep=reach)):
        return reached(lambda: worker._read((), Record(take=nothing)))


def pages_with_a_worker():
    pages = {str(k): Record(channel=Record(ended=False)) for k in range(20)}
    workers.Workers.of(Record(_of_pages=pages, end=pages.pop), "0")
    return len(pages)


def delay_of_an_interrupt():
    with process._no_interrupt_lost(), patch.object(process.threading, "Timer", lambda delay, _: reach(delay)):
        return reached(lambda: sys.unraisablehook(Record(exc_type=KeyboardInterrupt)))


def shown(call, **fields):
    """Return True if a display is shown or updated."""
    display = Record(
        _seen=True, _shown=None, _begun=0.0, _updated=0.0, _start=0.0, _end=1.0, _listener=Record(step=""),
        _started=lambda _: reach(True), _show=lambda **_: reach(True), **fields,
    )  # fmt: skip
    try:
        call(display)
    except Reached:
        return True
    return False


def shown_after():
    return count_while(lambda left: not shown(lambda bar: progress.CaseBar.__call__(bar, 0, 1, 0.1 * left)), DOUBLES)


def time_between_updates():
    def is_updated(passed):
        with patch.object(progress, "time", Record(monotonic=lambda: 100.0 + passed)):
            return shown(lambda bar: (setattr(bar, "_updated", 100.0), progress.ProgressBar.__call__(bar, 0.0)))

    return count_while(lambda passed: not is_updated(1e-3 * passed), DOUBLES)


def most_copies():
    """Return the number of copies by replicate, in quarter octaves of 100, from which on a file is refused."""

    def accepts(count):
        text = f'<mujoco><replicate count="{count}"/></mujoco>'
        with patch.object(mjcf, "file_text", lambda _: text):
            try:
                return [*mjcf._named(Path("a.xml"), Path())] == []
            except RobotFault:
                return False

    return count_while(lambda count: accepts(round(100 * count)), DOUBLES)


def most_included_files():
    """Return the number of files, in quarter octaves of 10, after which no further one is included."""

    def accepts(count):
        reader = files.Files(Path(), [None] * round(10 * count))
        by = Record(path=Path("a.sdf"), chain=())
        try:
            with patch.object(files, "isfile", lambda _: True), patch.object(files.Files, "source", lambda *_: None):
                return reader.included("a", "b.sdf", by) is None
        except RobotFault:
            return False

    return count_while(accepts, DOUBLES)


def axes_of_a_gearbox():
    """Return the angle between the axes of a gearbox and of its hinge, in quarter octaves below 0.9, where they are parallel."""

    def accepts(angle):
        hinge = Record(
            parent=None, child="wheel", kind="revolute", name="h", axes=[Record(direction=np.array([0, 0, 1.0]))]
        )
        try:
            return bool(
                gears._hinge(Record(where="g"), [hinge], None, "wheel", np.array([np.sin(angle), 0, np.cos(angle)]))
            )
        except RobotFault:
            return False

    return count_while(lambda angle: not accepts(angle), BELOW)


DECISIONS = {
    "robots.sdf.parameters:SdfParameters.files": most_included_files,
    "robots.sdf.parameters:SdfParameters.parallel": axes_of_a_gearbox,
    "live.app:LARGEST": largest_request,
    "live.page:FRAME_HEIGHT": height_of_a_frame,
    "live.requests:MOST_CASES": most_cases,
    "live.requests:MOST_INSTANTS": instants_of_a_band,
    "live.worker:BETWEEN": pause_before_the_end,
    "live.workers:MOST_PAGES": pages_with_a_worker,
    "commands.process:AGAIN": delay_of_an_interrupt,
    "commands.progress:SHOWN_AFTER": shown_after,
    "commands.progress:BETWEEN_UPDATES": time_between_updates,
    "robots.mjcf.model:MOST_COPIES": most_copies,
    "robots.scene.mechanism:ROUNDING": lambda: count_while(
        lambda turns: mechanism.whole_turns(np.pi + 2 * np.pi * turns) != 0.0, BELOW
    ),
}  # fmt: skip
EXPECTED = {
    "robots.sdf.parameters:SdfParameters.files": 27, "robots.sdf.parameters:SdfParameters.parallel": 40,
    "robots.mjcf.model:MOST_COPIES": 27,
    "live.app:LARGEST": 35, "live.page:FRAME_HEIGHT": 760, "live.requests:MOST_CASES": 41, "live.requests:MOST_INSTANTS": 400,
    "live.worker:BETWEEN": 0.2, "live.workers:MOST_PAGES": 6, "commands.process:AGAIN": 0.01, "commands.progress:SHOWN_AFTER": 18,
    "commands.progress:BETWEEN_UPDATES": 27, "robots.scene.mechanism:ROUNDING": 159,
}  # fmt: skip
