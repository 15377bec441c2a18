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
        ("stiffmbs/elements/joints/*.py", "stiffmbs/elements/spatial/joints/*.py", "stiffmbs/elements/spatial/primitives.py"),
        ELEMENTS,
    ),
    "forces": Area(
        ("stiffmbs/elements/forces/*.py", "stiffmbs/elements/spatial/forces/*.py", "stiffmbs/elements/spatial/*impact.py"),
        ELEMENTS,
    ),
    "tyres": Area(("stiffmbs/elements/tyres/*.py", "stiffmbs/elements/spatial/forces/*tyre.py"), ("tests/tyres", "tests/roads", *ELEMENTS)),
    "friction": Area(
        ("stiffmbs/elements/loads.py", "stiffmbs/elements/forces/*friction.py", "stiffmbs/elements/spatial/forces/joint_friction.py"),
        ("tests/elements/test_joint_friction.py", "tests/elements/test_spatial_joint_friction.py", "tests/adams", *ELEMENTS),
    ),
    "events": Area(
        ("stiffmbs/solve/events/*.py", "stiffmbs/solve/events/native/*.py", "stiffmbs/compile/inputs/*.py"),
        ("tests/events", "tests/compile/test_input_features.py", "tests/stress/tests/test_stress.py", "tests/solve"),
    ),
    "error_control": Area(
        ("stiffmbs/solve/error_control/*.py", "stiffmbs/solve/ida/native/error_norm.py", "stiffmbs/solve/explicit/native/*.py"),
        ("tests/solve", "tests/events", "tests/mechanisms"),
    ),
    "equilibria": Area(("stiffmbs/equilibria/*.py",), ("tests/linear_analysis",)),
    "linear_analysis": Area(("stiffmbs/linear_analysis/*.py",), ("tests/linear_analysis",)),
    "sensitivities": Area(
        ("stiffmbs/studies/sensitivities/*.py", "stiffmbs/sensitivity_equations/*.py"),
        ("tests/studies/test_sensitivities.py", "tests/studies"),
    ),
    "results": Area(("stiffmbs/results/*.py",), ("tests/results", "tests/analyses", "tests/verification")),
    "readers": Area(
        ("stiffmbs/adams/*/*.py", "stiffmbs/robots/*.py", "stiffmbs/robots/*/*.py", "stiffmbs/cad/*.py", "stiffmbs/cad/*/*.py", "stiffmbs/reading/files/*.py"),
        ("tests/robots", "tests/cad", "tests/adams", "tests/tyres", "tests/reading"),
    ),
}  # fmt: skip
