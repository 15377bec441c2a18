"""Assemblies of CAD programs on the command line."""

from pathlib import Path

import pytest
from click.testing import CliRunner

from stiffmbs.cad.load import load_cad
from stiffmbs.commands.main import main
from stiffmbs.model.read_scene import read_scene

from .simscape_files import CART

EXAMPLES = Path(__file__).parents[2] / "examples"


def _run(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


def test_an_assembly_is_converted_to_a_scene_and_to_another_assembly(tmp_path):
    (tmp_path / "rig.xml").write_text(CART)
    assert set(read_scene(_run("convert", tmp_path / "rig.xml").output).bodies) == {"base", "cart", "bob"}
    assert _run("convert", tmp_path / "rig.xml", "-o", tmp_path / "rig.asmt").exit_code == 0
    assert list(load_cad(tmp_path / "rig.asmt").joints) == list(load_cad(tmp_path / "rig.xml").joints)


def test_a_planar_scene_is_written_in_space_with_notes(tmp_path):
    done = _run("convert", EXAMPLES / "crank_slider.yaml", "-o", tmp_path / "slider.asmt")
    assert done.exit_code == 0 and "force push" in done.output
    assert set(load_cad(tmp_path / "slider.asmt").joints) == {"ground_pin", "crank_pin", "wrist_pin", "guide", "motor"}


@pytest.mark.parametrize(
    ("source", "options"),
    [("rig.xml", ()), (EXAMPLES / "heavy_top.yaml", ("-o", "top.adm")), (EXAMPLES / "four_bars.yaml", ("--in-space",))],
)
def test_positions_of_joints_are_for_robots(tmp_path, source, options):
    (tmp_path / "rig.xml").write_text(CART)
    done = _run("convert", tmp_path / source, "--at", "pin=1", *options)
    assert done.exit_code == 2 and "expected it with a robot alone" in done.output
