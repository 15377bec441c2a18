"""The command ``stiffmbs sensitivities``."""

import json

import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main

SCENE = """
parameters: {g: 10}
gravity: [0, -g]
bodies: {stone: {mass: 2, inertia: 1, velocity: [0, 3]}}
run: {duration: 0.5, rtol: 1e-6}
"""


@pytest.fixture
def scene(tmp_path):
    file = tmp_path / "stone.yaml"
    file.write_text(SCENE)
    return str(file)


def test_one_object_on_one_line(scene):
    ran = CliRunner().invoke(
        main, ["sensitivities", scene, "--to", "g,bodies.stone.velocity.1", "--of", "final(stone.y)", "--json"]
    )
    assert ran.exit_code == 0, ran.output
    (line,) = ran.output.splitlines()
    found = json.loads(line)
    assert set(found) == {"scene", "of", "value", "to"}
    assert found["value"] == pytest.approx(0.25)
    assert found["to"] == pytest.approx({"g": -0.125, "bodies.stone.velocity.1": 0.5})


def test_a_table_and_wrong_input(scene):
    told = CliRunner().invoke(main, ["sensitivities", scene, "--to", "g", "--of", "final(stone.y)"])
    assert told.exit_code == 0 and "d/d g" in told.output
    series = CliRunner().invoke(main, ["sensitivities", scene, "--to", "g", "--of", "stone.y"])
    assert series.exit_code == 2 and "expected a number such as peak(stone.y)" in series.output
