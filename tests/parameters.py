"""Halve and double each parameter of the solvers, and report those that change no result of a set of short runs.

    python -m tests.parameters [SUBSYSTEM...] [--json] [--all]
    python -m tests.parameters --untested PACKAGE

A value outside of its range is replaced by the middle between the default and the bound.  A result is every channel, counter,
note and message of a run; elapsed times are left out.  Runs with changed parameters compile the routines that read them, so that a
scan of all subsystems takes hours; set STIFFMBS_CACHE to a folder of its own.

``--untested`` runs nothing: it prints the parameters of a package that `.ci/parameters.py` counts, but no test halves and doubles. These
tests are tables in `tests.decisions` and `tests.solve`: decisions, thresholds, and counters of short runs.
"""

from __future__ import annotations

import argparse
import hashlib
import importlib.util
import json
import sys
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import stiffmbs
from stiffmbs import tuning
from stiffmbs.errors import StiffmbsError
from stiffmbs.model.tuning import bounds

ROOT = Path(__file__).parents[1]
EXAMPLES = ROOT / "examples"
SCENES = {
    "narrow": """
{bodies: {a: {mass: 1, inertia: 1}}, forces: {push: {type: force, i: a, force: ["1000*exp(-((t - 3.3)/0.004)^2)", 0]}}, run: {duration: 5 s}}
""",
    "sliding": """
{bodies: {a: {mass: 1, inertia: 1, velocity: [1, 0]}}, forces: {drag: {type: force, i: a, force: ["-2*sign(a.vx)", 0]}}, run: {duration: 1 s}}
""",
    "growing": """
{bodies: {a: {mass: 1, inertia: 1, velocity: [1, 0]}}, forces: {push: {type: force, i: a, force: ["100*a.x^3", 0]}}, run: {duration: 20 s}}
""",
    "damped": """
{bodies: {a: {mass: 1e-4, inertia: 1e-6, position: [1, 0]}}, gravity: [0, -9.81], joints: {j: {type: prismatic, i: a, j: ground}},
 forces: {d: {type: force, i: a, force: ["1 - 1e4*a.vx - 1e3*(a.x - 0.5)", 0]}}, run: {duration: 1 s}}
""",
}
"""Scenes of a few lines."""


CHANGED = "run.tuning changes parameters"
"""Beginning of the note that names changed parameters; it is no result."""


class Case(NamedTuple):
    """Short run of an example or of a scene of a few lines, with changed settings."""

    scene: str
    settings: dict[str, Any]

    @property
    def name(self) -> str:
        """The scene, and its settings without duration and points."""
        chosen = {key: value for key, value in self.settings.items() if key not in ("duration", "points")}
        return " ".join([self.scene, *(str(value) for value in chosen.values())])

    def counts(self, changes: tuning.Values | None = None) -> dict[str, int]:
        """Return the counters of a run and the number of its notes."""
        found = stiffmbs.run(_scene(self.scene), tuning=changes or {}, **self.settings)
        notes = sum(not note.startswith(CHANGED) for note in found.notes)
        return {name: value for name, value in found.solver.items() if isinstance(value, int)} | {"notes": notes}

    def result(self, changes: tuning.Values | None = None) -> str:
        """Return a digest of everything that a run gives, or its error."""
        try:
            found = stiffmbs.run(_scene(self.scene), tuning=changes or {}, **self.settings)
        except StiffmbsError as error:
            return str(error)
        counters = {name: value for name, value in found.solver.items() if "seconds" not in name}
        notes = [note for note in found.notes if not note.startswith(CHANGED)]
        digest = hashlib.sha256(repr((found.message, notes, sorted(counters.items()))).encode())
        for name in sorted(found.channels):
            digest.update(found.channels[name].tobytes())
        return digest.hexdigest()


@cache
def _scene(name: str) -> Any:
    return stiffmbs.read_scene(SCENES[name]) if name in SCENES else stiffmbs.load_scene(EXAMPLES / f"{name}.yaml")


_RUNS: tuple[tuple[Any, ...], ...] = (
    ("cart_pendulum", 2.0, {}, {"solver": "projected"}, {"rtol": 1e-10}, {"solver": "radau"}, {"solver": "radau", "rtol": 0.001}),
    ("half_car", 0.5, {}, {"solver": "auto"}, {"solver": "radau"}, {"rtol": 1e-9}, {"solver": "auto", "rtol": 1e-3}),
    ("bouncing_ball", 1.0, {}, {"solver": "projected"}, {"solver": "radau"}),
    ("stick_slip", 2.0, {}, {"solver": "projected"}),
    ("cam_follower", 1.0, {}, {"solver": "projected"}, {"solver": "projected", "scheme": "dopri5"}),
    ("crank_slider", 1.0, {"solver": "kinematic"}, {"solver": "auto"}),
    ("andrews", 0.03, {}, {"solver": "projected"}, {"rtol": 1e-3}),
    ("dead_centres", 2.0, {}, {"solver": "projected"}),
    ("simple_pendulum", 1.0, {"solver": "projected", "scheme": "rk4", "step": 3e-3}),
    ("dzhanibekov", 5.0, {}, {"solver": "projected"}, {"solver": "projected", "rtol": 1e-12}),
    ("heavy_top", 1.0, {}, {"solver": "radau"}),
    ("narrow", 5.0, {}, {"solver": "projected"}),
    ("sliding", 1.0, {}, {"solver": "projected"}, {"solver": "projected", "scheme": "rk4"}),
    ("growing", 20.0, {}, {"solver": "projected"}),
    ("damped", 1.0, {}, {"solver": "auto"}),
    ("chain", 0.5, {}, {"solver": "projected"}),
    ("four_bars", 0.5, {}, {"solver": "radau"}),
    ("spatial_chain", 0.2, {}, {"solver": "projected"}),
)  # fmt: skip
"""Scenes, durations in s, and settings of each run."""
CASES = tuple(
    Case(scene, {"duration": duration, "points": 101, **settings})
    for scene, duration, *variants in _RUNS
    for settings in variants
)


@cache
def usual(number: int) -> str:
    """Return the result of a case with the default parameters."""
    return CASES[number].result()


def changed(value: Any, factor: float) -> Any:
    """Return a value multiplied by a factor, or one between it and the bound that the factor exceeds."""
    if isinstance(value, int):
        return max(round(value * factor), 1) if factor < 1.0 or value > 0 else 1
    least, most = bounds(value)
    scaled = value * factor
    return scaled if least < scaled < most else (value + (least if scaled <= least else most)) / 2


def variations(name: str) -> Iterator[tuple[str, str, Any]]:
    """Yield the label, field and value of each changed parameter of a subsystem."""
    for field, value in tuning.numbers_of(tuning.defaults_of(name)).items():
        for factor in (0.5, 2.0):
            if isinstance(value, tuple):
                for k, each in enumerate(value):
                    yield f"{field}.{k}", field, (*value[:k], changed(each, factor), *value[k + 1 :])
            else:
                yield field, field, changed(value, factor)


def tested() -> dict[str, set[float]]:
    """Return the factors, 0.5 and 2, by which tests change each parameter: ``subsystem.field``, ``module:NAME``, ``module:Class.field``."""
    from tests.decisions import test_decisions
    from tests.solve import test_parameter_counts, test_parameter_thresholds

    found = {name: {0.5, 2.0} for name in test_decisions.TABLE}
    found |= {f"{name}.{field}": {0.5, 2.0} for name, field in test_parameter_thresholds.PARAMETERS}
    for name, _, _, halved, _, doubled in test_parameter_counts.TABLE:
        found.setdefault(name, set()).update({0.5} if halved is not None else (), {2.0} if doubled is not None else ())
    return found


def factors_of_tests(package: str) -> dict[str, tuple[set[float], int]]:
    """Return the factors of tests, and how many numbers it has, for each parameter of a package.

    A field of a class may have the names of several subsystems, of which one needs a test.
    """
    script = importlib.util.spec_from_file_location("parameters", ROOT / ".ci" / "parameters.py")
    assert script and script.loader
    counting = sys.modules[script.name] = importlib.util.module_from_spec(script)
    script.loader.exec_module(counting)
    subsystems: dict[str, list[str]] = {}
    for name in tuning.SUBSYSTEMS:
        subsystems.setdefault(type(tuning.defaults_of(name)).__name__, []).append(name)
    factors = tested()
    found = {}
    for file in sorted((ROOT / "stiffmbs" / package).glob("**/*.py")):
        module = ".".join(file.relative_to(ROOT / "stiffmbs").with_suffix("").parts)
        for parameter in counting.parameters(file):
            if parameter.column not in counting.COLUMNS[:2]:
                continue
            owner, _, field = parameter.name.rpartition(".")
            each = field.strip("()").split(", ")
            names = [f"{name}.{field}" for name in subsystems.get(owner, ())] or [
                f"{module}:{owner}.{one}" if owner else f"{module}:{one}" for one in each
            ]
            of_tests = [factors.get(name, set()) for name in names]
            both = set.intersection(*of_tests) if len(each) > 1 else set.union(*of_tests)
            found[f"{module}: {parameter.name}"] = both, parameter.numbers
    return found


def print_untested(package: str) -> None:
    """Print the parameters of a package that no test halves and doubles."""
    found = factors_of_tests(package)
    for name, (factors, _) in found.items():
        if len(factors) < 2:
            print(f"{name}: {'no test' if not factors else 'not halved' if 2.0 in factors else 'not doubled'}")
    count = sum(numbers for factors, numbers in found.values() if len(factors) == 2)
    print(
        f"{package}: {count} of {sum(numbers for _, numbers in found.values())} numbers are halved and doubled by tests"
    )


def first_changed(name: str, field: str, value: Any) -> str:
    """Return the first case with another result if a parameter is changed; empty if none."""
    for number, case in enumerate(CASES):
        if case.result({name: {field: value}}) != usual(number):
            return case.name
    return ""


def main() -> None:
    """Print a line for each parameter that changes nothing, or for all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("subsystems", nargs="*", choices=[*tuning.SUBSYSTEMS, []], default=[])
    parser.add_argument("--json", action="store_true", help="print one object a line")
    parser.add_argument("--all", action="store_true", help="print parameters that change a result, too")
    parser.add_argument("--untested", metavar="PACKAGE", help="print the parameters of a package without a test")
    asked = parser.parse_args()
    if asked.untested:
        print_untested(asked.untested)
        return
    for name in asked.subsystems or tuning.SUBSYSTEMS:
        found: dict[str, list[str]] = {}
        begun = time.monotonic()
        for label, field, value in variations(name):
            found.setdefault(label, []).append(first_changed(name, field, value))
        for label, by in found.items():
            row = {"parameter": f"{name}.{label}", "halved": by[0], "doubled": by[-1]}
            if asked.json:
                print(json.dumps(row), flush=True)
            elif asked.all or not any(by):
                print(f"{row['parameter']}: " + ("; ".join(filter(None, by)) or "changes nothing"), flush=True)
        if not asked.json:
            print(f"{name}: {len(found)} parameters, {time.monotonic() - begun:.0f} s", flush=True)


if __name__ == "__main__":
    main()
