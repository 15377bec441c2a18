"""Type checkers and completion see what the package offers: right uses pass, misspelt names are refused."""

import ast
import importlib.util
import inspect
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import stiffmbs
from stiffmbs import spatial
from stiffmbs.model.settings import Settings

ROOT = Path(stiffmbs.__file__).parent
RIGHT = """
from pathlib import Path
from typing import Literal, assert_type

import numpy as np

import stiffmbs
from stiffmbs import Body, Drive, Marker, Model, Report, Revolute, Scene, Solution, SpringDamper, Table, spatial

model = Model("Pendulum", gravity=(0, -9.81))
bar = model.add("bar", Body(mass="1.2 kg", inertia=0.036, position=[0.3, 0], markers={"end": {"point": [0.3, 0]}}))
model.add("hinge", Revolute(i=bar.at("-300 mm", 0), j="ground"))
post: Marker = Marker(body="ground", point=np.array([0.9, 0.0]))
model.add("spring", SpringDamper(i="bar.end", j=post, stiffness=np.float64(20), free_length=0.3))
model.add("motor", Drive(joint="hinge", position=Table(table=[[0, 0], [1, "2 rad"]])))
model.request("speed", "0.6*abs(bar.omega)")
bar.mass = 2
assert_type(model.run(duration=3.0, points=301, solver="bdf"), Solution)
assert_type(stiffmbs.run(model, rtol=1e-8), Solution)
assert_type(stiffmbs.run(Path("scene.yaml"), duration="3 s"), Solution)
assert_type(stiffmbs.verify("scene.yaml"), Solution)
assert_type(stiffmbs.check("scene.yaml"), Report)
assert_type(model.check(), Report)
stiffmbs.equilibrium("scene.yaml", start=1)
stiffmbs.modes(model, at=0.5, duration=1)
stiffmbs.transfer(model, ["bar.fy"], ["bar.y"])
assert_type(stiffmbs.load_scene("scene.yaml"), Scene)
assert_type(model.to_scene(), str)
model.replace(bar, Body(mass=1, inertia=1))
model.remove("spring")

top_model = spatial.Model("top", gravity=(0, 0, -9.81))
top = top_model.add("top", spatial.Body(mass=1, inertia=(0.03, 0.03, 0.01), omega=(0, 0, 100)))
top_model.add("tip", spatial.Spherical(i=top.at(0, 0, -0.2), j="ground"))
top_model.add("hinge", spatial.Revolute(i=top, j=spatial.Marker(body=top, orientation={"z": [0, 1, 0]})))
assert_type(spatial.in_space(model), spatial.Model)
"""
WRONG = {
    "stiffmbs.run(model, duraton=3)": 'Unexpected keyword argument "duraton"',
    "stiffmbs.run(model, solver='bfd')": "incompatible type \"Literal['bfd']\"",
    "stiffmbs.verify(model, rtoll=3)": 'Unexpected keyword argument "rtoll"',
    "stiffmbs.equilibrium(model, rtoll=3)": 'Unexpected keyword argument "rtoll"',
    "stiffmbs.modes(model, rtoll=3)": 'Unexpected keyword argument "rtoll"',
    "stiffmbs.check(3)": 'incompatible type "int"',
    "model.run(duraton=3)": 'Unexpected keyword argument "duraton"',
    "model.check(duraton=3)": 'Unexpected keyword argument "duraton"',
    "stiffmbs.Revolute(ii=3)": 'Unexpected keyword argument "ii"',
    "stiffmbs.Revolute(i='bar')": 'Missing named argument "j"',
    "stiffmbs.Revolute(i=3, j='ground')": 'incompatible type "int"',
    "stiffmbs.Body(mass=1, inertia=1, colour='red')": 'Unexpected keyword argument "colour"',
    "stiffmbs.spatial.Spherical(ii=3)": 'Unexpected keyword argument "ii"',
    "stiffmbs.RunSettings(duraton=3)": 'Unexpected keyword argument "duraton"',
    "model.add('bar', 3)": "No overload variant",
    "stiffmbs.runn(model)": 'has no attribute "runn"',
}
"""Lines, and what mypy says of each."""


def checked(folder: Path, text: str, *options: str) -> list[str]:
    """What mypy says of a program of a user's, without this package's own configuration."""
    (folder / "program.py").write_text(text)
    command = [sys.executable, "-m", "mypy", "--config-file=", "--strict", "--ignore-missing-imports", "program.py"]
    environment = {"MYPYPATH": str(ROOT.parent), "PATH": "", "MYPY_CACHE_DIR": str(folder / "cache")}
    found = subprocess.run([*command, *options], cwd=folder, env=environment, capture_output=True, text=True)
    assert not found.stderr
    return [line for line in found.stdout.splitlines() if line.startswith("program.py")]


@pytest.mark.long
@pytest.mark.parametrize("plugin", ["", "pydantic.mypy"])
@pytest.mark.sampled(2)
def test_mypy_accepts_what_is_right_and_refuses_what_is_misspelt(tmp_path, plugin):
    start = RIGHT.count("\n")
    (tmp_path / "mypy.ini").write_text(
        f"[mypy]\nplugins = {plugin}\n[mypy-stiffmbs.*]\nignore_errors = True\n"
    )  # as installed
    found = checked(tmp_path, RIGHT + "\n".join(WRONG), "--config-file=mypy.ini")
    said = {int(line.split(":")[1]) - start: line for line in found if ": error: " in line}
    assert said.keys() == set(range(1, len(WRONG) + 1)), "\n".join(found)
    for k, words in enumerate(WRONG.values(), 1):
        assert words in said[k]


def stubs() -> ModuleType:
    specification = importlib.util.spec_from_file_location("stubs", ROOT.parent / ".ci" / "stubs.py")
    assert specification is not None and specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.mark.parametrize("file", ["__init__.pyi", "spatial.pyi"])
def test_the_types_are_those_of_the_elements(file):
    made, kept = (ast.parse(text) for text in (stubs().stub(file), (ROOT / file).read_text()))
    for tree in (made, kept):
        tree.body.sort(key=ast.dump)  # imports are sorted where they are kept
    assert ast.dump(made) == ast.dump(kept), "run `python .ci/stubs.py`"


@pytest.mark.parametrize("module", [stiffmbs, spatial])
def test_the_types_name_what_is_offered(module):
    file = "__init__.pyi" if module is stiffmbs else "spatial.pyi"
    named = set(module.__all__)
    found = set()
    for node in ast.parse((ROOT / file).read_text()).body:
        match node:
            case ast.ClassDef(name):
                found.add(name)
            case ast.ImportFrom(names=names):
                found |= {alias.asname for alias in names if alias.asname and not alias.asname.startswith("_")}
            case ast.AnnAssign(ast.Name(name)):
                found.add(name)
    assert found - {"gym", "spatial", "__version__", "open"} == named  # a star import keeps the built-in open


@pytest.mark.parametrize("module", [stiffmbs, spatial])
def test_completion_finds_what_is_offered(module):
    assert set(module.__all__) <= set(dir(module))
    for name in module.__all__:
        assert getattr(module, name) is not None


@pytest.mark.parametrize(
    ("described", "names"),
    [
        (stiffmbs.run, Settings.__annotations__),
        (stiffmbs.Model.check, ["duration", "drop_first"]),
        (stiffmbs.Revolute, "ij"),
    ],
)
def test_completion_finds_fields_and_settings(described, names):
    assert set(names) <= inspect.signature(described).parameters.keys()


def test_settings_are_known_to_type_checkers():
    assert Settings.__annotations__.keys() == stiffmbs.RunSettings.model_fields.keys()


def test_importing_the_package_loads_no_solver():
    program = (
        "import sys, stiffmbs; dir(stiffmbs);"
        "print([name for name in ('scipy', 'sympy', 'sksundae', 'llvmlite', 'pandas', 'xarray', 'stiffmbs.solve', 'stiffmbs.compile', "
        "'stiffmbs.results', 'stiffmbs.analyses.run', 'stiffmbs.adams', 'stiffmbs.elements.spatial') if name in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "[]"


@pytest.mark.parametrize("name", ["si.Length", "fields.OfTime", "spatial.Body"])
def test_modules_are_attributes_of_the_package_from_the_start(name):
    subprocess.run([sys.executable, "-c", f"import stiffmbs; stiffmbs.{name}"], capture_output=True, check=True)
