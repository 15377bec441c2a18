"""Redundant equations on the command line: messages, JSON, exit status, and marks in every output."""

import json

import numpy as np
import pytest
from click.testing import CliRunner

from stiffmbs.commands.main import main

RAILS = """
name: Two rails
gravity: [0, -9.81]
bodies: {block: {mass: 1, inertia: 1}}
joints:
  rail: {type: prismatic, i: block, j: ground}
  guide: {type: prismatic, i: {body: block, point: [0, 1]}, j: {body: ground, point: [0, 1]}}
run: {duration: 0.1, points: 3}
"""


@pytest.fixture
def rails(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rails.yaml").write_text(RAILS)
    return tmp_path


def command(*arguments):
    return CliRunner().invoke(main, arguments)


def test_check_as_json(rails):
    result = command("check", "rails.yaml", "--json")
    assert result.exit_code == 1
    assert result.output.count("\n") == 1
    report = json.loads(result.output)
    assert list(report) == [
        "scene", "degrees_of_freedom", "equations", "rank", "redundant", "not_unique", "unknowns", "messages"
    ]  # fmt: skip
    assert report["redundant"] == [{"joint": "guide", "equation": "normal"}, {"joint": "guide", "equation": "angle"}]
    assert report["unknowns"] == {"before": 14, "after": 2}


def test_exit_status_of_check(rails, examples):
    assert command("check", str(examples / "cart_pendulum.yaml")).exit_code == 0
    assert command("check", "rails.yaml").exit_code == 1
    assert command("check", "nowhere.yaml").exit_code == 2
    assert command("check", "rails.yaml", "--set", "bodies.block.mass=0").exit_code == 2
    chosen = command("check", "rails.yaml", "--json", "--set", "run.drop_first=[rail]")
    assert {entry["joint"] for entry in json.loads(chosen.output)["redundant"]} == {"rail"}


def test_a_run_marks_what_is_not_unique_everywhere(rails):
    channels = ["rail.fy", "rail.torque", "guide.fy", "guide.torque"]
    summary = command("run", "rails.yaml")
    assert summary.exit_code == 0
    assert "*" in summary.output and "guide" in summary.output
    report = json.loads(command("run", "rails.yaml", "--json", "-o", "out.csv").output)
    assert report["not_unique"] == channels
    assert "rail.fy" in report["channels"]
    assert any("guide" in note for note in report["notes"])
    header = (rails / "out.csv").read_text().splitlines()[0].split(",")
    assert {f"{name}.not_unique" for name in channels} <= set(header)
    with np.load(rails / "rails.results.npz") as results:
        assert list(results["not_unique"]) == channels
    alone = json.loads(command("run", "rails.yaml", "--json", "--set", "gravity=[1, 0]").output)
    assert alone["channels"]["rail.fx"]["max"] == 0.0
