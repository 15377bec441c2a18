"""What notebooks show: figures once, comparisons as tables, animations as pages; films of short runs in slow motion."""

import builtins
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import stiffmbs
from stiffmbs.show.drawing.film import SHORTEST_FILM, Playback

EXAMPLES = Path(stiffmbs.__file__).parents[1] / "examples"


def test_a_plot_is_shown_once(monkeypatch):
    """By pyplot at the end of its cell; later by IPython, if it is the value of a cell."""
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    sheet = stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.1, points=3).plot("bar.x")
    assert sheet.number in pyplot.get_fignums()
    assert sheet._ipython_display_() is None
    pyplot.close(sheet)
    with pytest.raises(NotImplementedError):
        sheet._ipython_display_()


@pytest.mark.sampled(3)
@pytest.mark.long
@pytest.mark.parametrize("cell", ["run.plot('bar.x')", "run.plot('bar.x');", "found = run.plot('bar.x'); found"])
def test_a_cell_of_a_notebook_shows_one_picture(cell):
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    run = f"import stiffmbs; run = stiffmbs.run({str(EXAMPLES / 'bar_pendulum.yaml')!r}, duration=0.1, points=3)"
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source) for source in (run, cell)])
    nbclient.NotebookClient(notebook, timeout=300).execute()
    assert sum("image/png" in output.get("data", ()) for output in notebook.cells[1].outputs) == 1


def test_a_comparison_shows_its_table():
    found = stiffmbs.compare(
        EXAMPLES / "bar_pendulum.yaml", solvers=["bdf"], tolerances=[1e-4], repeats=1, duration=0.1
    )
    assert repr(found) == str(found) and "dataclass" not in repr(found) and "Comparison(" not in repr(found)
    assert "bdf" in repr(found) and len(repr(found)) < 3000


def test_an_animation_without_a_file_is_a_page(tmp_path):
    pytest.importorskip("jinja2")
    shown = stiffmbs.animate(EXAMPLES / "bar_pendulum.yaml", duration=0.1, points=3)
    assert shown is not None and shown._repr_html_().startswith("<iframe srcdoc=")
    assert stiffmbs.animate(EXAMPLES / "bar_pendulum.yaml", tmp_path / "a.html", duration=0.1, points=3) is None
    assert (tmp_path / "a.html").exists()


def test_a_solution_is_animated_with_the_scene_that_it_has_kept(tmp_path):
    pytest.importorskip("jinja2")
    found = stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.1, points=3)
    assert (
        stiffmbs.animate(found)._repr_html_()
        == stiffmbs.animate(EXAMPLES / "bar_pendulum.yaml", runs=found)._repr_html_()
    )
    with pytest.raises(
        stiffmbs.InputError, match=r"without its scene; give the scene too: stiffmbs.animate\(scene, runs=solution\)"
    ):
        stiffmbs.animate(replace(found, provenance=None))


@pytest.mark.parametrize(("length", "speed"), [(0.1, 0.1 / SHORTEST_FILM), (SHORTEST_FILM, 1.0), (10.0, 1.0)])
def test_short_runs_are_shown_in_slow_motion(length, speed):
    instants = Playback().instants(2.0, 2.0 + length)
    assert np.diff(instants) == pytest.approx(speed / 25)
    assert instants[-1] == pytest.approx(2.0 + length, abs=speed / 25)
    assert len(Playback(speed=1.0).instants(0.0, 0.1)) == 3
    assert len(Playback().instants(0.0, 0.0)) == 2


def test_printed_modes_fit_on_a_screen():
    found = stiffmbs.modes(EXAMPLES / "half_car.yaml")
    lines = str(found).splitlines()
    assert lines[0] == f"Half car at t = {found.t:g} s: 9 degrees of freedom"
    assert lines[1].split()[:2] == ["Hz", "damping"] and len(lines) == 2 + 9 + len(found.notes)
    assert repr(found) == f"<Modes {lines[0]}>"
    many = replace(found, modes=found.modes * 10)
    assert len(str(many).splitlines()) < 25 and "and 70 more modes" in str(many)
    assert len(many.table().splitlines()) == 2 + 90 + len(found.notes)
    assert "<td>rigid body</td>" in found._repr_html_()


def test_results_of_analyses_are_shown_in_one_line():
    scene = stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml")
    transfer = stiffmbs.transfer(scene, inputs=["bar.fy"], outputs=["bar.y"])
    for found in (stiffmbs.equilibrium(scene), stiffmbs.run(scene, duration=0.1).balance, transfer):
        assert len(repr(found)) < 120 and repr(found).startswith(f"<{type(found).__name__}")


def test_names_of_the_package_replace_no_built_in():
    assert not set(stiffmbs.__all__) & set(dir(builtins))
