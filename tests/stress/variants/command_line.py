"""Commands in a process of their own, with bounds of memory and time."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

MEMORY = 6_000_000_000
"""Bytes that a command may have: what reads without bound ends there."""
PATIENCE = 20.0
"""Time, s, after which a command is ended."""


def command(folder: Path, words: list[str]) -> tuple[int, str, str]:
    """Run a command in a folder, and return its exit status, standard output and standard error."""
    package = str(Path(__file__).parents[3])
    path = os.pathsep.join(filter(None, (package, os.environ.get("PYTHONPATH"))))
    bounded = ["prlimit", f"--as={MEMORY}"]  # a function in the child would need a copy of this process's memory
    done = subprocess.run(
        [*bounded, sys.executable, "-m", "stiffmbs", *words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, check=False,
        timeout=PATIENCE, env={**os.environ, "PYTHONPATH": path, "COLUMNS": "300"},
    )  # fmt: skip
    return done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")
