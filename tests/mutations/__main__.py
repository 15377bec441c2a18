"""Try random mutations of the package, and list those that the nearest tests do not detect."""

from __future__ import annotations

import argparse
import fnmatch
import json
import queue
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from .areas import AREAS
from .covering import Covering
from .operators import Mutation, mutations
from .trial import EQUIVALENT, ROOT, Result, copy_repository, try_mutation


def drawn(areas: list[str], count: int, seed: int) -> list[tuple[str, Mutation]]:
    """Draw mutations, as many from each area as from any other; the same seed draws the same ones."""
    rng = random.Random(seed)
    found: list[tuple[str, Mutation]] = []
    for place, area in enumerate(areas):
        share = count // len(areas) + (place < count % len(areas))
        known = sorted({path for pattern in AREAS[area].sources for path in ROOT.glob(pattern)})
        every = [m for path in known for m in mutations(path.relative_to(ROOT).as_posix(), path.read_bytes())]
        possible = [mutation for mutation in every if not _declared_equivalent(mutation)]
        found += [(area, mutation) for mutation in rng.sample(possible, min(share, len(possible)))]
    return found


def _declared_equivalent(mutation: Mutation) -> bool:
    return EQUIVALENT in (ROOT / mutation.path).read_text().splitlines()[mutation.line - 1]


def results(
    trials: list[tuple[str, Mutation]], covering: Covering | None, jobs: int, time_limit: float, long: bool
) -> Iterator[tuple[str, Result]]:
    """Try mutations in several copies of the repository; results come as they are ready."""
    with tempfile.TemporaryDirectory() as place, ThreadPoolExecutor(jobs) as pool:
        free: queue.SimpleQueue[Path] = queue.SimpleQueue()
        for job in range(jobs):
            copy_repository(Path(place) / str(job))
            free.put(Path(place) / str(job))

        def one(area: str, mutation: Mutation) -> tuple[str, Result]:
            folder = free.get()
            try:
                tests = covering.tests(mutation, AREAS[area]) if covering else AREAS[area].tests
                return area, try_mutation(mutation, folder, tests, time_limit, long)
            finally:
                free.put(folder)

        for future in as_completed([pool.submit(one, *trial) for trial in trials]):
            yield future.result()


def as_line(area: str, result: Result) -> str:
    """Return one line of text on a result."""
    mutation = result.mutation
    source = (ROOT / mutation.path).read_bytes()
    old = source[mutation.start : mutation.end].decode()
    line = source.splitlines()[mutation.line - 1].decode().strip()
    verdict = f"detected by {result.detected_by}" if result.detected_by else "SURVIVES"
    return f"{verdict}  [{area}] {mutation.path}:{mutation.line} {mutation.kind} '{old}' -> '{mutation.new}'  {line}"


def as_json(area: str, result: Result) -> str:
    """Return one JSON object on a result."""
    place = {"area": area, "path": result.mutation.path, "line": result.mutation.line, "kind": result.mutation.kind}
    return json.dumps(
        {**place, "new": result.mutation.new, "detected_by": result.detected_by, "seconds": result.seconds}
    )


def main() -> int:
    """Try mutations; the exit status is 1 if fewer than nine of ten are detected."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutations", description=__doc__)
    parser.add_argument("--count", type=int, default=300, help="number of mutations, spread evenly over the areas")
    parser.add_argument("--seed", type=int, default=1, help="seed of the draw")
    parser.add_argument("--area", action="append", choices=sorted(AREAS), help="only this area (may be repeated)")
    parser.add_argument("--path", default="*", help="only files that match this pattern")
    parser.add_argument(
        "--coverage", type=Path, help="coverage file with contexts: run only the tests that execute a line"
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--time-limit", type=float, default=600.0, help="for the tests of one mutation, s")
    parser.add_argument("--long", action="store_true", help="run tests marked long as well")
    parser.add_argument("--json", action="store_true", help="one JSON object a line")
    options = parser.parse_args()
    trials = drawn(options.area or sorted(AREAS), options.count, options.seed)
    trials = [trial for trial in trials if fnmatch.fnmatch(trial[1].path, options.path)]
    covering = Covering(options.coverage) if options.coverage else None
    tried: Counter[str] = Counter()
    survived: Counter[str] = Counter()
    for area, result in results(trials, covering, options.jobs, options.time_limit, options.long):
        print(as_json(area, result) if options.json else as_line(area, result), flush=True)
        tried[area] += 1
        survived[area] += not result.detected_by
    detected = tried.total() - survived.total()
    by_area = ", ".join(f"{area} {tried[area] - survived[area]}/{tried[area]}" for area in sorted(tried))
    print(f"{detected} of {tried.total()} mutations detected ({by_area})", file=sys.stderr)
    return 0 if detected >= 0.9 * tried.total() else 1


if __name__ == "__main__":
    sys.exit(main())
