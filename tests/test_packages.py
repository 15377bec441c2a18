"""The structure of the package: imports go one way, in the order of a run, and folders stay small."""

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import stiffmbs

ROOT = Path(stiffmbs.__file__).parent
ORDER = (
    "cache", "reading", "flexible_bodies", "elements", "model", "adams", "robots", "cad", "compile", "presolve", "sparse", "dynamics", "solve", "equilibria", "sensitivity_equations", "linear_analysis", "redundancy",
    "results", "run_checks", "error_estimate", "analyses", "verification", "evaluation", "studies", "show", "comparison", "real_time", "live", "commands",
)  # fmt: skip
"""Packages; each imports from those before it alone."""
ANYWHERE = {"errors", "interrupts", "methods", "notes", "processes", "solver_names", "tuning"}
MOST_FILES, DEEPEST = 25, 3
MODULES = {(ROOT.name, *path.relative_to(ROOT).with_suffix("").parts): path for path in sorted(ROOT.glob("**/*.py"))}


def _module(path: Path) -> tuple[str, ...]:
    return (ROOT.name, *path.relative_to(ROOT).with_suffix("").parts)


def _imports(module: tuple[str, ...], statements: Iterator[ast.AST]) -> Iterator[tuple[str, ...]]:
    """What the imports among some statements name: modules, or packages."""
    for node in statements:
        if isinstance(node, ast.ImportFrom):
            start = module[: len(module) - node.level] if node.level else ()
            base = (*start, *(node.module or "").split(".")) if node.module else start
            if base[:1] == (ROOT.name,):
                for alias in node.names:
                    named = (*base, alias.name)
                    yield named if named in MODULES or (*named, "__init__") in MODULES else base


def _statements(tree: ast.AST, *left_out: type[ast.AST]) -> Iterator[ast.AST]:
    """The nodes of a module but for some types, what they contain, and what is for type checkers alone."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, left_out) or (isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)):
            continue
        yield node
        yield from _statements(node, *left_out)


@pytest.mark.parametrize("package", sorted(path.parent.name for path in ROOT.glob("*/__init__.py")))
def test_a_package_imports_from_packages_before_it_alone(package):
    allowed = {*ORDER[: ORDER.index(package) + 1], *ANYWHERE}
    for path in sorted((ROOT / package).glob("**/*.py")):
        tree = ast.parse(path.read_text())
        found = {name[1] for name in _imports(_module(path), _statements(tree)) if len(name) > 1}
        assert found <= allowed, f"{path} imports from {sorted(found - allowed)}"


def test_no_module_imports_itself_through_others():
    """A circle raises `graphlib.CycleError`, which names its modules."""
    needed = {}
    for module, path in MODULES.items():
        found = _imports(module, _statements(ast.parse(path.read_text()), ast.FunctionDef, ast.AsyncFunctionDef))
        needed[module] = {name for name in found if name in MODULES}
    tuple(TopologicalSorter(needed).static_order())


def test_the_figure_and_the_table_of_rooms_have_the_packages_in_their_order():
    page = (ROOT.parent / "docs" / "project" / "architecture.md").read_text(encoding="utf-8")
    assert tuple(re.findall(r"^\| `stiffmbs/(\w+)` \|", page, re.MULTILINE)) == ORDER
    lines = re.findall(r"^ \w+ {2,}(\w+(?:, \w+)*)$", page.partition("## Rooms")[2], re.MULTILINE)
    assert tuple(name for line in lines for name in line.split(", ")) == ORDER


def _folders() -> Iterator[Path]:
    """All folders of the repository but for what tools leave there, and for the films of the gallery."""
    for top in (".ci", "docs", "examples", ROOT.name, "tests"):
        yield from (
            folder
            for folder in sorted((ROOT.parent / top).glob("**/"))
            if folder.name not in ("__pycache__", "gallery")
        )


@pytest.mark.parametrize("folder", [ROOT.parent, *_folders()], ids=lambda folder: str(folder.relative_to(ROOT.parent)))
def test_a_folder_holds_few_files(folder):
    assert len([path for path in folder.iterdir() if path.is_file()]) <= MOST_FILES


def test_a_planar_scene_loads_nothing_of_space():
    """Each package of space is loaded where a scene in space is read."""
    program = (
        "import sys, stiffmbs;"
        "text = '{bodies: {a: {mass: 1, inertia: 1}}, requests: {r: accx(a) + az(a) + energy.total}}';"
        "stiffmbs.run(stiffmbs.read_scene(text), duration=1);"
        "print(*[name for name in sys.modules if name.startswith('stiffmbs.') and 'spatial' in name])"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not found.stdout.split()


def test_a_spatial_scene_loads_no_planar_kinds():
    """Bases and equations that both have in common are in files of their own."""
    program = (
        "import sys, stiffmbs;"
        f"stiffmbs.run({str(ROOT.parent / 'examples' / 'car.yaml')!r}, duration=0.01);"
        "print(*sys.modules)"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    planar = [f"forces.{name}" for name in ("bushing", "line_force", "spring_damper", "torsion_spring")]
    planar += ["joints.fixed", "joints.planar_pair", "planar_kinds"]
    unused = {"model.model", "elements.spatial.flexible.inertia", *(f"elements.{name}" for name in planar)}
    assert not {f"stiffmbs.{name}" for name in unused} & set(found.stdout.split())


@pytest.mark.parametrize("scene", ["cart_pendulum", "half_car"])
def test_a_run_without_tables_and_events_loads_no_masked_arrays_and_random_numbers(scene):
    """`numpy.unique` and the functions of sets load masked arrays; both are 3 % of a short run."""
    program = (
        "import sys, stiffmbs;"
        f"stiffmbs.run({str(ROOT.parent / 'examples' / f'{scene}.yaml')!r}, duration=0.1);"
        "print(*sys.modules)"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert not {"numpy.ma", "numpy.random"} & set(found.stdout.split())


def test_help_loads_nothing_heavy():
    """The package, and the command with all its subcommands: what describes, computes or draws is loaded where it is used."""
    program = (
        "import sys, atexit, stiffmbs; from stiffmbs.commands.main import main;"
        "atexit.register(lambda: print(*sys.modules)); main(['--help'])"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "stiffmbs.commands.vehicles" in found.stdout.split()
    heavy = {"numpy", "pydantic", "yaml", "sympy", "scipy", "rich", "hashlib", "importlib.metadata"}
    assert not heavy & set(found.stdout.split())


def test_a_command_loads_no_other():
    """What fits or draws is not loaded for a run; a name that is none loads all, to suggest one."""
    program = "import sys; from stiffmbs.commands.main import main; main.get_command(None, 'run'); print(*sys.modules)"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert "stiffmbs.commands.run" in found.stdout.split()
    assert not {"stiffmbs.commands.fit", "stiffmbs.commands.pictures"} & set(found.stdout.split())


def test_a_warm_run_changes_package_rarely(monkeypatch):
    """Measured: 97 files and 285 changes among 24 packages; among 17 larger ones there were 131 changes.

    The estimate of the errors takes 17 files and fewer than 10 changes for each channel.
    """
    monkeypatch.syspath_prepend(ROOT.parent / ".ci")
    from package_calls import warm_run

    scene = str(ROOT.parent / "examples" / "cart_pendulum.yaml")
    alone, calls = warm_run(scene, errors=False), warm_run(scene)
    assert len(alone.files) < 99 and len(alone.changes) < 287
    assert len(calls.files - alone.files) < 20 and len(calls.changes) - len(alone.changes) < 10 * 38


def test_a_warm_run_loads_few_modules():
    """Measured: 290 in a run of a planar scene that was read and compiled before; faults, and what other scenes need, are loaded on demand."""
    program = (
        "import sys, stiffmbs;"
        f"stiffmbs.run({str(ROOT.parent / 'examples' / 'cart_pendulum.yaml')!r}, duration=0.1);"
        "print(*sys.modules)"
    )
    command = [sys.executable, "-c", program]
    _, found = (subprocess.run(command, capture_output=True, text=True, check=True) for _ in range(2))
    loaded = {name.removeprefix("stiffmbs.") for name in found.stdout.split() if name.startswith("stiffmbs.")}
    assert len(loaded) < 293
    rare = {
        "model.read_scene",
        "model.parts.definitions",
        "elements.states.state",
        "redundancy.overconstraint",
        "run_checks.tables",
    }
    rare |= {"elements.shape", "elements.roads.road", "elements.states.equation", "elements.forces.friction"}
    rare |= {"elements.joints.drive", "elements.joints.relation", "model.files.stages"}
    rare |= {"solve.explicit.scheme", "solve.events.narrow_inputs", "analyses.conditions", "analyses.given_inputs"}
    assert not rare & loaded


def test_a_scene_loads_few_kinds_of_elements_that_it_does_not_use():
    """A torque and a drive stand in files of other names."""
    program = (
        "import sys, stiffmbs;"
        "text = '{dimensions: 3, bodies: {a: {mass: 1, inertia: [1, 1, 1]}}, forces: {f: {type: torque, i: a, torque: [0, 0, 1]}}}';"
        "stiffmbs.read_scene(text);"
        "print(*[name for name in sys.modules if name.startswith('stiffmbs.elements.spatial.forces.')])"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert {name.rpartition(".")[2] for name in found.stdout.split()} == {"applied", "gyroscopic_torque"}


@pytest.mark.parametrize(
    "folder", sorted({path.parent for path in ROOT.glob("**/*.*") if "__pycache__" not in path.parts}), ids=str
)
def test_no_folder_lies_deeper_than_three_levels(folder):
    assert len(folder.relative_to(ROOT).parts) <= DEEPEST
