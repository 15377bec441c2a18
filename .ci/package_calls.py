"""How often a run changes from one package to another, and how many files it touches.

    python .ci/package_calls.py [SCENE] [--pairs | --sequence]

Counts calls of the package's functions (sys.setprofile) in the second of two equal runs, so that kernels are at hand and modules
loaded.  A change is a call in another package than the call before it; a returning generator counts as a call.
"""

from __future__ import annotations

import argparse
import gc
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any

import stiffmbs

ROOT = f"{Path(stiffmbs.__file__).parent}/"
PARAMETERS = "tuning.py"
"""File with the values of solver parameters; reading one is not counted as a call."""


@dataclass
class Calls:
    """The calls of a run.

    Attributes
    ----------
    files : set of str
        Those whose functions are called.
    changes : list of (str, str, str)
        The package before, the package called, and the function by file and name.
    """

    files: set[str] = field(default_factory=set)
    changes: list[tuple[str, str, str]] = field(default_factory=list)
    _package: str = ""

    def note(self, frame: FrameType, event: str, argument: Any) -> None:
        """Take note of a call; for `sys.setprofile`."""
        file = frame.f_code.co_filename
        if event != "call" or not file.startswith(ROOT):
            return
        file = file.removeprefix(ROOT)
        if file == PARAMETERS:
            return
        package = file.partition("/")[0]
        self.files.add(file)
        if self._package and package != self._package:
            self.changes.append((self._package, package, f"{file}:{frame.f_code.co_name}"))
        self._package = package


def warm_run(scene: str, **changes: Any) -> Calls:
    """The calls of the second run of a scene."""
    model, calls = stiffmbs.load_scene(scene), Calls()
    stiffmbs.run(model, **changes)
    gc.collect()  # what earlier runs of this process have left is let go now, not in the middle of the run
    sys.setprofile(calls.note)
    try:
        stiffmbs.run(model, **changes)
    finally:
        sys.setprofile(None)
    return calls


def main() -> None:
    """Print the counts, and what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", nargs="?", default="examples/cart_pendulum.yaml")
    parser.add_argument("--pairs", action="store_true", help="changes by caller and callee")
    parser.add_argument("--sequence", action="store_true", help="every change in its order")
    asked = parser.parse_args()
    calls = warm_run(asked.scene)
    print(f"{len(calls.files)} files, {len(calls.changes)} changes of package")
    if asked.pairs:
        for (before, package), count in Counter(
            (before, package) for before, package, _ in calls.changes
        ).most_common():
            print(f"{count:4} {before} -> {package}")
    if asked.sequence:
        for before, _, function in calls.changes:
            print(f"{before} -> {function}")


if __name__ == "__main__":
    main()
