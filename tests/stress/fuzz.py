"""Random cases by the thousand, each made from a seed and judged in a process of its own."""

from __future__ import annotations

import importlib
import json
import math
import pkgutil
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from stiffmbs.errors import InputError

from . import fuzzers as package
from .case import Outcome, Verdict
from .child import TIME_LIMIT, Child


@dataclass(frozen=True)
class Trial:
    """One random case: its seed, what came of it, and how long it took, s."""

    seed: int
    verdict: Verdict
    seconds: float

    def line(self) -> str:
        """One line of text."""
        error = "" if math.isnan(self.verdict.error) else f"{self.verdict.error:.1e} of {self.verdict.allowed:.0e}  "
        return f"{self.verdict.outcome.value}  seed {self.seed}: {error}{self.verdict.detail}"

    def as_json(self) -> str:
        """One JSON object on one line; numbers that are none become null."""
        verdict = self.verdict
        numbers = {"error": verdict.error, "allowed": verdict.allowed, "seconds": self.seconds}
        found = {key: value if math.isfinite(value) else None for key, value in numbers.items()}
        return json.dumps({"seed": self.seed, "outcome": verdict.outcome.value, "detail": verdict.detail, **found})


def fuzzers() -> dict[str, str]:
    """Return the modules of `tests.stress.fuzzers` by fuzzer name, with hyphens instead of underscores."""
    found = [m.name for m in pkgutil.walk_packages(package.__path__, f"{package.__name__}.") if not m.ispkg]
    return {name.rpartition(".")[2].replace("_", "-"): name for name in found}


def module_of(name: str) -> str:
    """The module of a fuzzer.

    Raises
    ------
    InputError
        When there is no such fuzzer; says which there are.
    """
    known = fuzzers()
    if name in known:
        return known[name]
    listed = "; ".join(f"{key} ({importlib.import_module(module).WHAT})" for key, module in sorted(known.items()))
    raise InputError(f"found the fuzzer '{name}', expected one of these: {listed}")


def trials(module: str, seeds: Iterable[int], time_limit: float = TIME_LIMIT) -> Iterator[Trial]:
    """Try seeds one after the other in a child process, which is started anew after a hang or a crash.

    Parameters
    ----------
    module : str
        Has the function ``trial(seed) -> Verdict``.
    seeds : iterable of int
    time_limit : float
        Time, s, after which a trial is wrong, for it does not end.

    Yields
    ------
    Trial
    """
    child = Child(module, time_limit)
    try:
        for seed in seeds:
            yield Trial(seed, *child.tried(seed))
    finally:
        child.close()


def summary(found: Iterable[Trial]) -> str:
    """How many trials had which outcome: right, told and WRONG always, others where there are any."""
    counts = dict.fromkeys(Outcome, 0)
    for trial in found:
        counts[trial.verdict.outcome] += 1
    shown = (Outcome.RIGHT, Outcome.TOLD, Outcome.WRONG)
    listed = ", ".join(f"{n} {outcome.value}" for outcome, n in counts.items() if n or outcome in shown)
    return f"{sum(counts.values())} trials: {listed}"
