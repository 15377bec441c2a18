"""One mutation on trial: the nearest tests run in a copy of the repository until one fails."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from .operators import Mutation

ROOT = Path(__file__).parents[2]
COPIED = ("stiffmbs", "tests", "examples", "docs", "pyproject.toml", "README.md")
EQUIVALENT = "# mutation:"
"""Comment that declares the mutations of its line equivalent, followed by the reason."""


@dataclass(frozen=True)
class Result:
    """A mutation and the first test that failed.

    Attributes
    ----------
    mutation : Mutation
    detected_by : str
        Name of the test, 'time limit', or '' if the mutation survives.
    seconds : float
        Duration of the tests, s.
    """

    mutation: Mutation
    detected_by: str
    seconds: float


def copy_repository(folder: Path) -> None:
    """Copy all that the tests need to a folder."""
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns("__pycache__", ".*"))
        else:
            shutil.copy(source, folder / name)


def try_mutation(mutation: Mutation, folder: Path, tests: tuple[str, ...], time_limit: float, long: bool) -> Result:
    """Run tests on one mutation in a copy of the repository, until one fails.

    Parameters
    ----------
    mutation : Mutation
    folder : Path
        The copy, which is restored afterwards.
    tests : tuple of str
        Test files and folders in the order in which they run.
    time_limit : float
        Time, s, after which the mutation counts as detected: the package hangs.
    long : bool
        Whether tests marked ``long`` run as well.
    """
    path = folder / mutation.path
    original = path.read_bytes()
    began = time.monotonic()
    path.write_bytes(mutation.applied(original))
    try:
        detected = _first_failure(folder, tests, time_limit, long)
    finally:
        path.write_bytes(original)
    return Result(mutation, detected, time.monotonic() - began)


def _first_failure(folder: Path, tests: tuple[str, ...], time_limit: float, long: bool) -> str:
    marked = "long or not long" if long else "not long"
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-x",
        "-n",
        "0",
        "-m",
        marked,
        "-p",
        "no:cacheprovider",
        "--tb=no",
        *tests,
    ]
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=time_limit)
    except subprocess.TimeoutExpired:
        return "time limit"
    if done.returncode == 0:
        return ""
    found = re.search(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
    return found[1] if found else f"pytest's exit status {done.returncode}"
