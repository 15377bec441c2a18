"""Assemblies of CAD programs, something changed in their text: read, checked and run for a moment."""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path
from random import Random

from stiffmbs.analyses.check import check
from stiffmbs.analyses.load_scene import load_scene
from stiffmbs.analyses.run import run
from stiffmbs.cad.load import convert_cad, is_cad
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.read_scene import read_scene
from stiffmbs.solve.trajectory import Outcome as Ending

from ..case import Outcome, Verdict
from ..file_bases import ASSEMBLIES
from ..simulation import patience
from .datasets import another_channel
from .files import CHANGES, MOMENT, PATIENCE, shown, told, unsaid_channels

WHAT = (
    "Simscape Multibody XML or an .asmt file with bytes, numbers, words or lines changed: refused in a sentence, or run with "
    "finite results that the converted scene has too"
)


def trial(seed: int) -> Verdict:
    """One file made from the seed, and what came of it."""
    random = Random(seed)
    suffix, base = random.choice(ASSEMBLIES)
    content = base.encode()
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        content = random.choices(*zip(*CHANGES, strict=True))[0](content, random)
    try:
        with warnings.catch_warnings(), tempfile.TemporaryDirectory() as folder:
            warnings.simplefilter("error")
            path = Path(folder) / f"rig{suffix}"
            path.write_bytes(content)
            return _tried(path)
    except StiffmbsError as error:
        return told(str(error))
    except Exception as error:  # whatever it is, no user should have seen it
        return Verdict(Outcome.WRONG, detail=f"{type(error).__name__}: {str(error)[:200]}")


def _tried(path: Path) -> Verdict:
    if not is_cad(path):
        return Verdict(Outcome.TOLD, detail="read as another format")
    scene = load_scene(path)
    str(check(scene))
    duration = min(MOMENT, scene.run.duration)
    solution = run(scene, watch=patience(PATIENCE), duration=duration, points=5)
    shown(solution)
    if solution.outcome is not Ending.DONE:
        return told(solution.message)
    unsaid = unsaid_channels(solution)
    if unsaid:
        return Verdict(
            Outcome.WRONG, detail=f"done, but {unsaid[0]} is no number at some time; notes: {solution.notes}"
        )
    again = run(read_scene(convert_cad(path)), watch=patience(PATIENCE), duration=duration, points=5)
    other = another_channel(solution, again)
    if other:
        return Verdict(Outcome.WRONG, detail=f"the converted scene has another {other}")
    return Verdict(Outcome.RIGHT, detail="; ".join(solution.notes))
