"""All cases, and what comes of them."""

from __future__ import annotations

import importlib
import pkgutil
import time
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from stiffmbs.errors import InputError

from . import families as package
from .case import Case, Verdict, tried


@dataclass(frozen=True)
class Row:
    """One line of the table: a case, what came of it, and how long it took, s."""

    family: str
    case: Case
    verdict: Verdict
    seconds: float

    def as_dict(self) -> dict[str, Any]:
        """The object of ``python -m tests.stress --json``."""
        verdict = self.verdict
        return {
            "family": self.family, "case": self.case.name, "what": self.case.what, "outcome": verdict.outcome.value,
            "expected": self.case.expected.value, "error": verdict.error, "allowed": verdict.allowed,
            "detail": verdict.detail, "seconds": self.seconds,
        }  # fmt: skip


def catalogue() -> dict[str, tuple[Case, ...]]:
    """The cases of every file of `tests.stress.families`, by the family's name."""
    found = pkgutil.walk_packages(package.__path__, f"{package.__name__}.")
    modules = {module.name.rpartition(".")[2]: module.name for module in found if not module.ispkg}
    return {family: importlib.import_module(modules[family]).CASES for family in sorted(modules)}


def chosen(names: Iterable[str], quick: bool) -> list[tuple[str, Case]]:
    """Cases with their families: those named, by a family or by a case, or all; of these the quick ones where asked.

    Raises
    ------
    InputError
        When a name is neither a family nor a case.
    """
    known = catalogue()
    names = set(names)
    every = [(family, case) for family, cases in known.items() for case in cases]
    unknown = names - known.keys() - {case.name for _, case in every}
    if unknown:
        raise InputError(f"found the case '{min(unknown)}', expected a case or a family: {', '.join(known)}")
    wanted = [(family, case) for family, case in every if not names or family in names or case.name in names]
    return [(family, case) for family, case in wanted if case.quick or not quick]


def outcomes(cases: Iterable[tuple[str, Case]]) -> Iterator[Row]:
    """Try the cases one after the other."""
    for family, case in cases:
        begun = time.perf_counter()
        verdict = tried(case.judge)
        yield Row(family, case, verdict, time.perf_counter() - begun)
