"""Roads by files of heights on a grid, and what is wrong with such files."""

import math

import numpy as np
import pytest

from stiffmbs import InputError, load_scene, run
from stiffmbs.roads import GridRoad
from stiffmbs.spatial import VerticalTyre

from ..tyres.wheels import wheel

FILE = """# x down, y across
  -1.0, 0.0, 2.0
0  0.10 0.00 0.04   # the start
4  0.30 0.00 0.04
8; 0.50; 0.00; 0.04
"""


@pytest.fixture
def grid(tmp_path):
    def written(text=FILE):
        (tmp_path / "road.txt").write_text(text)
        return tmp_path / "road.txt"

    return written


def loaded(road, x, y):
    """The load of an upright wheel of radius 0.3 m, 0.3 m above the level of zero."""
    model = wheel(VerticalTyre(i="wheel", radius=0.3, stiffness=1e5, road=road), 0.3, 0.0)
    body = model.data().bodies["wheel"].model_copy(update={"position": (x, y, 0.3)})
    return model.data().model_copy(update={"bodies": {"wheel": body}})


def deflection(road, x, y):
    from stiffmbs import compile_model
    from stiffmbs.compile.reactions import reactions
    from stiffmbs.compile.state import State

    system = compile_model(loaded(road, x, y))
    state = State(system)
    state.evaluate("output", 0.0)
    return float(reactions(system, state.values["output"][None, :])["tyre.deflection"][0])


def test_drawn_heights_are_interpolated_between_lines(grid):
    x, y = np.array([3.0, 3.0, 4.0, 8.0, 4.0]), np.array([2.5, 1.0, 0.5, -1.0, -1.0])
    assert GridRoad(file=grid()).heights(x, y).tolist() == pytest.approx([0.04, 0.02, 0.01, 0.5, 0.3])


@pytest.mark.long
def test_heights_between_lines(grid):
    road = GridRoad(file=grid())
    assert deflection(road, 3.0, 2.5) == pytest.approx(0.04, abs=1e-9)  # beyond the last line
    assert deflection(road, 3.0, 1.0) == pytest.approx(0.02 * math.cos(math.atan(0.02)), rel=5e-3)
    assert deflection(road, 4.0, 0.5) == pytest.approx(0.01, rel=5e-3)


@pytest.mark.long
def test_a_scene_finds_the_file_beside_it(grid, tmp_path):
    grid()
    scene = """
dimensions: 3
gravity: [0, 0, -9.81]
roads: {field: {type: grid, file: road.txt}}
bodies: {wheel: {mass: 100, inertia: [1, 1, 1], position: [2, 5, 0.34], velocity: [0, 0, 0]}}
forces: {tyre: {type: vertical_tyre, i: wheel, radius: 0.3, stiffness: 1e5, damping: 2000, road: field}}
run: {duration: 2, points: 3}
"""
    (tmp_path / "scene.yaml").write_text(scene)
    found = run(load_scene(tmp_path / "scene.yaml"))
    assert found["tyre.load"][-1] == pytest.approx(981, rel=1e-3)
    assert found["wheel.z"][-1] == pytest.approx(0.34 - 0.00981, abs=1e-5)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("4  0.30", "4  high", "line 4: found 'high', expected a number"),
        ("4  0.30 0.00 0.04", "4  0.30 0.00", "line 4: found 3 numbers, expected x and 3 heights"),
        ("8; 0.50", "3; 0.50", "line 5: found x = 3 after 4, expected increasing positions"),
        ("-1.0, 0.0", "-1.0, -1.0", "line 2: found y = -1 after -1, expected increasing positions"),
        ("-1.0, 0.0, 2.0", "2.0", "line 2: found 1 positions y, expected 2 to 32"),
        ("0.10", "nan", "line 3: found 'nan', expected a finite number"),
        (FILE, "# nothing", "found 0 rows of numbers"),
    ],
)
def test_faults_are_told_with_their_lines(grid, old, new, said):
    with pytest.raises(InputError, match=said):
        GridRoad(file=grid(FILE.replace(old, new, 1)))


def test_a_file_that_is_not_there():
    with pytest.raises(InputError, match="nowhere"):
        GridRoad(file="nowhere.txt")
