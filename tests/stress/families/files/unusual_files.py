"""Devices, pipes, folders and huge files where a scene or a command names a file: refused in one sentence."""

from __future__ import annotations

import os
from functools import partial
from pathlib import Path

from ...case import Case, Outcome, Verdict, told
from ...variants.answers import with_files
from ...variants.command_line import command
from .changed_files import MAGIC, wheel

HUGE = 600_000_000
"""Bytes of a sparse file, more than is read of any file."""
CART = {"scene.yaml": "bodies: {b: {mass: 1, inertia: 1}}\nrun: {duration: 0.01, points: 2}\n"}
RUN = ["run", "scene.yaml"]
ASKED: tuple[tuple[str, str, dict[str, str], list[str]], ...] = (
    ("device", "x.yaml", {}, ["run", "x.yaml"]), ("pipe", "x.adm", {}, ["check", "x.adm"]), ("device", "x.urdf", {}, ["run", "x.urdf"]),
    ("huge", "x.yaml", {"scene.yaml": "include: x.yaml\n"}, RUN), ("device", "car.tir", wheel(force=MAGIC), RUN),
    ("device", "x.txt", wheel("{type: grid, file: x.txt}"), RUN), ("pipe", "x.txt", wheel("{type: grid, file: x.txt}"), ["check", "scene.yaml"]),
    ("device", "x.crg", wheel("{type: crg, file: x.crg}"), RUN), ("folder", "x.crg", wheel("{type: crg, file: x.crg}"), RUN),
    ("device", "x.stl", wheel(mesh="{type: mesh, file: x.stl}"), ["draw", "scene.yaml", "-o", "o.json"]),
    ("pipe", "x.npz", CART, [*RUN, "--from", "x.npz"]), ("huge", "x.csv", CART, ["diff", "x.csv", "x.csv"]),
    ("pipe", "o.nc.study", CART, ["study", "scene.yaml", "--vary", "bodies.b.mass=1,2", "-o", "o.nc"]),
    ("device", "x.csv", CART, ["fit", "scene.yaml", "--data", "x.csv", "--parameter", "bodies.b.mass=0.5:2"]),
)  # fmt: skip
"""The kind of an unusual file, its name, the files beside it, and a command."""


def _placed(kind: str, path: Path) -> None:
    if kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        with path.open("wb") as file:
            file.truncate(HUGE)


def _judged(kind: str, name: str, words: list[str], folder: Path) -> Verdict:
    _placed(kind, folder / name)
    status, _, err = command(folder, words)
    if status != 2 or len(err.strip().splitlines()) != 1:
        return Verdict(Outcome.WRONG, detail=f"exit status {status}: {err[-300:]}")
    return told(err.strip(), (name,))


CASES = tuple(
    Case(f"{kind} {name}: {' '.join(words)}", "one sentence, exit status 2", partial(with_files, files, partial(_judged, kind, name, words)), Outcome.TOLD)
    for kind, name, files, words in ASKED
)  # fmt: skip
