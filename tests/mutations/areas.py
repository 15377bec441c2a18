"""Areas of the package, and the tests nearest to each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Area:
    """Files whose mutations are tried, and the tests that should detect them.

    Attributes
    ----------
    sources : tuple of str
        Patterns of files, from the root of the repository.
    tests : tuple of str
        Test files and folders, the quickest to detect a fault first.
    """

    sources: tuple[str, ...]
    tests: tuple[str, ...]


ELEMENTS = ("tests/elements", "tests/mechanisms")
RUNS = ("tests/solve", "tests/events", "tests/analyses", "tests/elements")
AREAS = {
    "joints": Area(
        ("stiffmbs/describe/joints/*.py", "stiffmbs/describe/spatial/joints/*.py", "stiffmbs/describe/spatial/primitives.py"),
        ELEMENTS,
    ),
    "forces": Area(
        ("stiffmbs/describe/forces/*.py", "stiffmbs/describe/spatial/forces/*.py", "stiffmbs/describe/spatial/*impact.py"),
        ELEMENTS,
    ),
    "tyres": Area(("stiffmbs/describe/tyres/*.py", "stiffmbs/describe/spatial/forces/*tyre.py"), ("tests/tyres", *ELEMENTS)),
    "friction": Area(
        ("stiffmbs/describe/forces/*friction.py", "stiffmbs/describe/spatial/forces/joint_friction.py"),
        ("tests/elements/test_joint_friction.py", "tests/elements/test_spatial_joint_friction.py", "tests/adams", *ELEMENTS),
    ),
    "events": Area(
        ("stiffmbs/solve/events/*.py", "stiffmbs/solve/native/event_search/*.py", "stiffmbs/compile/inputs/*.py"),
        ("tests/events", "tests/compile/test_input_features.py", "tests/stress/test_stress.py", "tests/solve"),
    ),
    "error_control": Area(
        ("stiffmbs/solve/error_control/*.py", "stiffmbs/solve/native/error_norm.py", "stiffmbs/solve/native/explicit/*.py"),
        ("tests/solve", "tests/events", "tests/mechanisms"),
    ),
    "equilibria": Area(("stiffmbs/solve/equilibria/*.py",), ("tests/linear_analysis",)),
    "linear_analysis": Area(("stiffmbs/linear_analysis/*.py",), ("tests/linear_analysis",)),
    "sensitivities": Area(
        ("stiffmbs/studies/sensitivities/*.py", "stiffmbs/solve/variations/*.py"),
        ("tests/studies/test_sensitivities.py", "tests/studies"),
    ),
    "results": Area(("stiffmbs/results/*.py", "stiffmbs/results/native/*.py"), ("tests/results", "tests/analyses", "tests/verification")),
    "readers": Area(
        ("stiffmbs/adams/*/*.py", "stiffmbs/robots/*.py", "stiffmbs/robots/*/*.py", "stiffmbs/describe/files/*.py"),
        ("tests/robots", "tests/adams", "tests/tyres", "tests/describe"),
    ),
}  # fmt: skip
