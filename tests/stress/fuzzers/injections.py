"""Run commands under injected faults: a full disk, damaged stores and caches, unusual names, signals at random times.

Each command runs in a separate process.  It must end with one sentence, the proper exit status, and no traceback.  A file that it
writes is complete or unchanged.  A repeated study has the same table as one without faults.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from random import Random
from typing import Any
from xml.etree import ElementTree

import numpy as np
from scipy.io import loadmat

from stiffmbs.cache.entries import DIRECTORY_VARIABLE

from ..case import Outcome, Verdict

WHAT = (
    "Commands under a full disk, damaged stores and caches, unusual names and signals: a sentence, a status, no loss."
)
SCENE = """
parameters: {k: 40 N/m}
bodies: {sled: {mass: 2 kg, inertia: 0.1, velocity: [1, 0]}}
joints: {rail: {type: prismatic, i: sled, j: ground}}
forces:
  spring: {type: spring_damper, i: {body: sled, point: [0, 0]}, j: {body: ground, point: [-3, 0]}, stiffness: k, damping: 1, free_length: 3}
requests: {where: sled.x}
figure: {x: time, y: [where], title: sled}
run: {duration: 0.5 s, points: 51}
"""
STUDY = ["study", "IN", "--vary", "k=40,50,60,70", "--of", "final(where)", "-o", "OUT.csv", "--json"]
COMMANDS = (
    ["run", "IN", "-o", "OUT.npz", "--json"], ["run", "IN", "-o", "OUT.csv"], ["run", "IN", "-o", "OUT.nc"], ["run", "IN", "-o", "OUT.res"],
    ["run", "IN", "--duration", "1e7", "--set", "run.output=1", "-o", "OUT.npz", "--json"], ["run", "IN", "--verify", "--json"],
    ["run", "IN", "--from", "state.npz", "-o", "OUT.tab"], ["check", "IN", "--json"], ["equilibrium", "IN", "-o", "OUT.npz"],
    ["modes", "IN", "--json"], ["response", "IN", "--input", "sled.fx", "--output", "sled.x", "-o", "OUT.csv"], STUDY,
    [*STUDY, "--workers", "2"], ["sensitivities", "IN", "--of", "final(where)", "--to", "k", "--json"], ["draw", "IN", "-o", "OUT.svg"],
    ["animate", "IN", "-o", "OUT.html"], ["report", "IN", "-o", "OUT.html"], ["convert", "IN", "-o", "OUT.adm"], ["fmu", "IN", "-o", "OUT.fmu"],
    ["plot", "state.npz", "where", "-o", "OUT.png"], ["diff", "state.npz", "state.npz"], ["cache", "show", "--json"],
    ["fit", "IN", "--data", "state.npz", "--parameter", "k=30:60", "--json"], ["version"], ["init", "OUT.yaml"],
)  # fmt: skip
LIMITS = (0, 1, 100, 4096, 20_000, 200_000)
"""Largest file size on a full disk, bytes."""
NAMES = (
    "-x", " ", "a b", "ünï", "日本", "\u202ex", "a\x9bb", "a\nb", "'quoted'", '"', "$(x)", "*", "~", "%s", "{x}", "a=b", "#", "x" * 200, "x" * 255,
    "CON", "..x", "\udcff", "a:b", "[1]", "<b>", "\\",
)  # fmt: skip
STATUSES = (0, 1, 2, 130, 143)
LATEST = 2.5
"""Latest time of a signal, s."""
PATIENCE = 120.0


@dataclass
class Session:
    """Command with an injected fault.

    Attributes
    ----------
    folder : Path
        Working folder.
    command : list of str
    environment : dict of str to str
    limit : int or None
        Largest file size, bytes.
    full_output : bool
        True if standard output is a full device.
    signals : list of (float, int)
        Times and numbers of the signals; 0 closes standard output.
    may_fail : bool
        True if an exit status other than 0 is allowed.
    """

    folder: Path
    command: list[str]
    environment: dict[str, str]
    limit: int | None = None
    full_output: bool = False
    signals: list[tuple[float, int]] = field(default_factory=list)
    may_fail: bool = True


def trial(seed: int) -> Verdict:
    """Run one command with one fault."""
    random = Random(seed)
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        (folder / "in.yaml").write_text(SCENE, encoding="utf-8")
        shutil.copy(_state(), folder / "state.npz")
        session = Session(folder, list(random.choice(COMMANDS)), {})
        inject = random.choice(INJECTIONS)
        told = inject(session, random)
        session.command = [word.replace("IN", "in.yaml").replace("OUT", "out") for word in session.command]
        old = random.random() < 0.5 and _with_old_output(session)
        detail = f"{inject.__name__.strip('_')} {told}: {' '.join(session.command)[:150]!r}"
        status, out, err = _run(session)
        fault = _fault(session, status, out, err, bool(old)) or _lost(session, random)
    return Verdict(
        Outcome.WRONG if fault else Outcome.RIGHT, detail=f"{fault}; {detail}" if fault else f"{status}, {detail}"
    )


def _full_disk(session: Session, random: Random) -> str:
    session.limit = random.choice(LIMITS)
    if random.random() < 0.5:  # also where nothing has been compiled or read
        session.environment[DIRECTORY_VARIABLE] = str(session.folder / "cache")
        shutil.copytree(_cache(), session.folder / "cache")
        for entry in random.sample(_entries(session.folder / "cache"), 2):
            entry.unlink()
    return f"of {session.limit} bytes"


def _full_output(session: Session, random: Random) -> str:
    session.full_output = True
    return ""


def _damaged_cache(session: Session, random: Random) -> str:
    session.environment[DIRECTORY_VARIABLE] = str(session.folder / "cache")
    shutil.copytree(_cache(), session.folder / "cache")
    session.may_fail = False
    entries = _entries(session.folder / "cache")
    damages = [random.choice(DAMAGES) for _ in range(random.choice((1, 3, 10)))]
    for damage, entry in zip(damages, random.sample(entries, min(len(damages), len(entries))), strict=False):
        damage(entry, random)
    return ", ".join(damage.__name__.strip("_") for damage in damages)


def _damaged_store(session: Session, random: Random) -> str:
    session.command = list(STUDY)
    store = session.folder / "out.csv.study"
    shutil.copy(_store(), store)
    damage = random.choice(DAMAGES)
    damage(store, random)
    return damage.__name__.strip("_")


def _unusual_name(session: Session, random: Random) -> str:
    name = random.choice(NAMES)
    which = random.choice(("IN", "OUT", "FOLDER"))
    try:
        if which == "FOLDER":
            (session.folder / name).mkdir()
            (session.folder / name / "in.yaml").write_text(SCENE)
        elif which == "IN":
            (session.folder / f"{name}.yaml").write_text(SCENE)
    except OSError:  # no file has this name
        pass
    places = {"IN": (f"{name}.yaml", "out"), "OUT": ("in.yaml", name), "FOLDER": (f"{name}/in.yaml", f"{name}/out")}
    scene, output = places[which]
    session.command = [word.replace("IN", scene).replace("OUT", output) for word in session.command]
    return f"{which} {ascii(name)[:40]}"


def _signals(session: Session, random: Random) -> str:
    numbers = [signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGPIPE", signal.SIGINT), 0]
    times = sorted(random.uniform(0.0, LATEST) for _ in range(random.choice((1, 1, 2, 5))))
    session.signals = [(time, random.choice(numbers)) for time in times]
    return ", ".join(f"{number} at {time:.2f} s" for time, number in session.signals)


INJECTIONS: tuple[Callable[[Session, Random], str], ...] = (
    _full_disk, _full_output, _damaged_cache, _damaged_store, _unusual_name, _signals, _signals,
)  # fmt: skip


def _flipped(path: Path, random: Random) -> None:
    content = bytearray(path.read_bytes() or b"\0")
    for _ in range(random.choice((1, 10, 1000))):
        content[random.randrange(len(content))] ^= 1 << random.randrange(8)
    path.write_bytes(content)


def _cut(path: Path, random: Random) -> None:
    content = path.read_bytes()
    path.write_bytes(content[: random.randrange(len(content) + 1)])


def _garbage(path: Path, random: Random) -> None:
    path.write_bytes(random.randbytes(random.choice((0, 1, 100, 10_000))))


def _folder(path: Path, random: Random) -> None:
    path.unlink()
    path.mkdir()


def _pipe(path: Path, random: Random) -> None:
    path.unlink()
    os.mkfifo(path)


def _gone(path: Path, random: Random) -> None:
    path.unlink()


def _unreadable(path: Path, random: Random) -> None:
    path.chmod(0)


DAMAGES = (_flipped, _cut, _garbage, _folder, _pipe, _gone, _unreadable)


def _run(session: Session) -> tuple[int, bytes, bytes]:
    """Run a session; return exit status, standard output and standard error."""

    # programs that replace themselves by the command: a function in the child would need a copy of this process's memory
    limited = ["env", "--default-signal=INT"]
    if session.limit is not None:
        limited += ["prlimit", f"--fsize={session.limit}"]
    package = str(Path(__file__).parents[3])
    path = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH"))))
    with open(os.devnull if not session.full_output else "/dev/full", "wb") as other:
        process = subprocess.Popen(
            [*limited, sys.executable, "-m", "stiffmbs", *session.command], cwd=session.folder, stdin=subprocess.DEVNULL,
            stdout=other if session.full_output else subprocess.PIPE, stderr=subprocess.PIPE,
            env={**os.environ, "PYTHONPATH": path, "COLUMNS": "300", **session.environment},
        )  # fmt: skip
    begun = 0.0
    if session.signals:
        _wait_for_handler(process.pid)
    try:
        for at, number in session.signals:
            try:
                process.wait(at - begun)
            except subprocess.TimeoutExpired:
                begun = at
                if number:
                    process.send_signal(number)
                elif process.stdout:
                    process.stdout.close()
                    process.stdout = None
        out, err = process.communicate(timeout=PATIENCE if not _endless(session) else LATEST)
    except subprocess.TimeoutExpired:
        if not _endless(session):
            process.kill()
            return -int(signal.SIGKILL), *process.communicate()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=PATIENCE)
    return process.returncode, out or b"", err


def _wait_for_handler(pid: int) -> None:
    """Wait until a process handles SIGTERM: before that, Python has not begun to run the command."""
    status, bit = Path(f"/proc/{pid}/status"), 1 << (signal.SIGTERM - 1)
    until = time.monotonic() + LATEST
    while time.monotonic() < until:
        try:
            caught = next(line for line in status.read_text().splitlines() if line.startswith("SigCgt:"))
        except (OSError, StopIteration):  # it has ended, or the system has no such information
            return
        if int(caught.split()[1], 16) & bit:
            return
        time.sleep(1e-3)


def _endless(session: Session) -> bool:
    """Return True for a run that ends only when it is interrupted."""
    return "1e7" in session.command


def _fault(session: Session, status: int, out: bytes, err: bytes, old: bool) -> str:
    """Describe the fault in the end of a command; empty if there is none."""
    words = err.decode(errors="replace").strip()
    lines = [line for line in words.splitlines() if not line.startswith("stiffmbs: note:")]
    if "Traceback" in words or "Error ignored" in words:
        return f"a traceback: {words[-300:]!r}"
    if status not in STATUSES:
        return f"exit status {status}: {words[-200:]!r}"
    if status and not session.may_fail and not _endless(session):
        return f"exit status {status} where the command needs no more than it has: {words[-200:]!r}"
    closed = any(number in (0, getattr(signal, "SIGPIPE", 0)) for _, number in session.signals)
    early = status == 130  # before Python has loaded what tells
    if status and not lines and not closed and not early and not _says_why(out):
        return f"exit status {status} without a sentence"
    if len(lines) > 2 and not words.startswith("Usage:"):
        return f"more than a sentence: {words[-300:]!r}"
    if "--json" in session.command and out and not closed and not session.full_output:
        try:
            json.loads(out)
        except ValueError:
            return f"no JSON: {out[-100:]!r}"
    return _half_written(session, status, old)


def _says_why(out: bytes) -> bool:
    """Return True for a report of a run that stopped."""
    return b"interrupted" in out or b"stopped" in out or b"not written" in out or b'"error"' in out


def _output(session: Session) -> Path | None:
    """Return the file that a command writes."""
    asked = session.command.index("-o") + 1 if "-o" in session.command else None
    return session.folder / session.command[asked] if asked else None


OLD = b"an old file"


def _with_old_output(session: Session) -> bool:
    output = _output(session)
    try:
        return bool(output and not output.exists() and output.write_bytes(OLD))
    except (OSError, ValueError):
        return False


def _half_written(session: Session, status: int, old: bool) -> str:
    """Describe the fault of the file that a command writes, which must be the old one, none, or whole."""
    left = [path.name for path in session.folder.rglob(".part-*") if "cache" not in path.parts]
    if left:
        return f"a part of a file is left: {left}"
    output = _output(session)
    try:
        content = output.read_bytes() if output and output.is_file() else None
    except (OSError, ValueError):
        return ""
    if output is None or (content == OLD and status):
        return ""
    if content is None:
        return "the old file is gone" if old else "no file where all is done" if not status else ""
    try:
        READERS[output.suffix](output, content)
    except Exception as error:  # whatever it is, the file is not whole
        return f"half a file {output.name} ({error})"
    return ""


def _ends(end: bytes) -> Callable[[Path, bytes], Any]:
    def read(path: Path, content: bytes) -> None:
        if not content.rstrip().endswith(end):
            raise ValueError(f"it ends with {content[-20:]!r}")

    return read


def _archive(path: Path, content: bytes) -> None:
    with zipfile.ZipFile(path) as archive:
        archive.testzip()


def _netcdf(path: Path, content: bytes) -> None:
    from scipy.io import netcdf_file

    with netcdf_file(path, mmap=False) as file:
        assert file.variables["time"][:].size


def _table(path: Path, content: bytes) -> None:
    assert content.endswith(b"\n") and len({line.count(b",") for line in content.splitlines()}) == 1


READERS: dict[str, Callable[[Path, bytes], Any]] = {
    ".npz": lambda path, content: dict(np.load(path)), ".mat": lambda path, content: loadmat(path), ".xlsx": _archive, ".parquet": _ends(b"PAR1"), ".csv": _table, ".nc": _netcdf, ".fmu": _archive,
    ".res": lambda path, content: ElementTree.fromstring(content), ".svg": lambda path, content: ElementTree.fromstring(content),
    ".html": _ends(b"</html>"), ".adm": _ends(b"END"), ".tab": _ends(b""), ".png": _ends(b"IEND\xaeB`\x82"),
}  # fmt: skip


def _lost(session: Session, random: Random) -> str:
    """Describe the results that a study lost: run again, it must give the complete table or name a damaged store."""
    if session.command[0] != "study" or (output := _output(session)) is None or not _plain(session):
        return ""
    again = Session(session.folder, session.command, {})
    status, out, err = _run(again)
    if status == 2 and b"remove the file" in err:
        return ""
    if status or json.loads(out)["cases"] != json.loads(_study())["cases"]:
        return f"the study given again ends with {status} and another table: {err[-300:]!r}"
    return "" if output.is_file() else "no table"


def _plain(session: Session) -> bool:
    return all(word.isascii() and word.isprintable() for word in session.command) and "in.yaml" in session.command


@cache
def _prepared() -> Path:
    """Return a folder with a cache in which all commands have run, a saved state, and the store of an interrupted study."""
    folder = Path(tempfile.mkdtemp(prefix="injections-"))
    (folder / "in.yaml").write_text(SCENE)
    environment = {DIRECTORY_VARIABLE: str(folder / "cache")}
    for command in (["run", "in.yaml", "-o", "state.npz"], ["modes", "in.yaml"], ["equilibrium", "in.yaml"]):
        _run(Session(folder, command, environment))
    from stiffmbs.reading.variation import read_variation
    from stiffmbs.studies.sweep import study_of

    study = study_of(str(folder / "in.yaml"), [read_variation(STUDY[3], "--vary")], None, 0, (STUDY[5],), {})

    def stop(done: int, *_: Any) -> None:
        if done == 2:
            raise KeyboardInterrupt

    with suppress(KeyboardInterrupt):
        study.solve(store=folder / "store", watch=stop)
    return folder


def _cache() -> Path:
    return _prepared() / "cache"


def _state() -> Path:
    return _prepared() / "state.npz"


def _store() -> Path:
    return _prepared() / "store"


@cache
def _study() -> bytes:
    return _run(Session(_prepared(), [word.replace("IN", "in.yaml").replace("OUT", "out") for word in STUDY], {}))[1]


def _entries(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())
