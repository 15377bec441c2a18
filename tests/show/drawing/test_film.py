"""Films and plots: as many pictures as time asks for, what moves in them, what is refused."""

import json
import subprocess

import numpy as np
import pytest
from click.testing import CliRunner

import stiffmbs
from stiffmbs import InputError
from stiffmbs.commands.main import main
from stiffmbs.show.drawing.animate import traced
from stiffmbs.show.drawing.derive import drawing_of
from stiffmbs.show.drawing.film import Playback, _ffmpeg, pictures
from stiffmbs.show.drawing.picture import Shown
from stiffmbs.show.drawing.poses import Poses, followed_body, poses_of
from stiffmbs.show.drawing.view import view_named
from stiffmbs.show.figure import drawn, figure_of, plotted_runs

from ...conftest import EXAMPLES

Image = pytest.importorskip("PIL.Image")


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_poses_between_instants_turn_the_shorter_way():
    half = np.radians([5, 15])
    signs = np.array([[1.0], [-1.0]])  # p and -p are one orientation
    turns = signs * np.column_stack([np.cos(half), 0 * half, 0 * half, np.sin(half)])
    poses = Poses(np.array([0.0, 2.0]), {"a": np.array([[0.0, 0, 0], [4, 2, 0]])}, {"a": turns})
    found = poses.resampled(np.array([1.0, 5.0]))
    assert found.points["a"].tolist() == [[2, 1, 0], [4, 2, 0]]
    assert abs(found.orientations["a"][0]) == pytest.approx([np.cos(np.radians(10)), 0, 0, np.sin(np.radians(10))])


def test_instants_without_values_are_left_out():
    points = np.array([[0.0, 0, 0], [np.nan, 0, 0], [2, 0, 0]])
    poses = Poses(np.arange(3.0), {"a": points}, {"a": np.tile([1.0, 0, 0, 0], (3, 1))})
    assert poses.resampled(np.array([1.0])).points["a"][0, 0] == pytest.approx(1)


@pytest.mark.long
def test_a_gif_has_a_picture_for_each_instant(tmp_path):
    path = tmp_path / "x.gif"
    result = run(
        "animate",
        EXAMPLES / "four_bar.yaml",
        "-o",
        path,
        "--speed",
        2,
        "--rate",
        10,
        "--trace",
        "coupler.tip",
        "--json",
    )
    assert result.exit_code == 0, result.output
    assert json.loads(result.output)["time"] == {"start": 0.0, "end": 1.0}
    film = Image.open(path)
    assert film.n_frames == 6  # 1 s at double speed, ten pictures a second, both ends
    assert film.info["duration"] == 100
    pixels = []
    for k in (0, 3):
        film.seek(k)
        pixels.append(np.asarray(film.convert("RGB")).astype(int))
    assert (np.abs(pixels[1] - pixels[0]).max(axis=2) > 60).mean() > 0.005


@pytest.mark.long
@pytest.mark.skipif(_ffmpeg() is None, reason="no ffmpeg is installed")
def test_an_mp4_is_one(tmp_path):
    path = tmp_path / "x.mp4"
    assert run("animate", EXAMPLES / "bar_pendulum.yaml", "-o", path, "--duration", 0.2, "--rate", 20).exit_code == 0
    told = subprocess.run([_ffmpeg(), "-i", path], capture_output=True, text=True).stderr
    assert "Video: h264" in told and "20 fps" in told


def test_other_runs_are_faint_and_under_the_first():
    """Of two runs that are one, the second changes nothing where the first is drawn."""
    scene = stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml")
    solution = stiffmbs.run(scene, duration=0.2)
    poses = poses_of(scene, solution.time, solution.channels)
    drawing = drawing_of(scene)
    view = view_named("", 2, drawing.gravity)
    one, both = (
        next(pictures(drawing, runs, view, Playback(rate=5), Shown(False, False), []))
        for runs in ({"a": poses}, {"a": poses, "b": poses})
    )
    assert (np.ptp(one.astype(int), axis=2) > 40).sum() > 1000
    shifted = Poses(poses.time, {"bar": poses.points["bar"] - [0, 0.3, 0]}, poses.orientations)
    apart = next(pictures(drawing, {"a": poses, "b": shifted}, view, Playback(rate=5), Shown(False, False), []))
    orange = (apart[:, :, 0].astype(int) - apart[:, :, 2] > 60).sum()
    assert orange > (both[:, :, 0].astype(int) - both[:, :, 2] > 60).sum() + 500


def test_a_trace_is_the_path_of_its_marker():
    scene = stiffmbs.load_scene(EXAMPLES / "four_bar.yaml")
    solution = stiffmbs.run(scene)
    poses = poses_of(scene, solution.time, solution.channels)
    (anchor,) = traced(scene, ["coupler.tip"])
    assert poses.path(anchor)[:, :2] == pytest.approx(np.column_stack([solution["tip_x"], solution["tip_y"]]), abs=1e-9)


def test_one_trace_instead_of_a_list_is_refused():
    with pytest.raises(stiffmbs.InputError, match=r"traces: found 'coupler.tip', expected a list of"):
        traced(stiffmbs.load_scene(EXAMPLES / "four_bar.yaml"), "coupler.tip")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("-o", "x.avi"), "found the ending '.avi', expected one of .gif, .mp4, .html"),
        (("-o", "x.gif", "--speed", "0"), "--speed: found 0, expected a number greater than 0"),
        (("-o", "x.gif", "--speed", "1e-6"), "expected at most 3000"),
        (
            ("-o", "x.gif", "--trace", "coupler.nose"),
            "found 'coupler.nose', expected a body or a marker of one such as coupler.",
        ),
        (("-o", "x.html", "--view", "behind"), "--view: found 'behind'"),
        (("missing.npz", "-o", "x.html"), "missing.npz"),
    ],
)
def test_wrong_input_is_told(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    result = run("animate", EXAMPLES / "four_bar.yaml", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr
    assert not list(tmp_path.iterdir())


def test_results_of_another_scene_are_refused(tmp_path):
    stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.1).save(tmp_path / "bar.npz")
    result = run("animate", EXAMPLES / "four_bar.yaml", tmp_path / "bar.npz", "-o", tmp_path / "x.html")
    assert result.exit_code == 2
    assert "found results without the channel" in result.stderr


def test_each_unit_has_its_plot_and_every_line_a_stroke_of_its_own():
    solution = stiffmbs.run(EXAMPLES / "cart_pendulum.yaml", duration=1)
    runs = {"a": solution, "b": solution}
    sheet = plotted_runs(runs, figure_of(runs, ("rail.fy", "cart.x", "bar.x"), "time"))
    assert [axes.get_ylabel() for axes in sheet.axes] == ["rail.fy (N)", "m"]
    lines = [line for axes in sheet.axes for line in axes.get_lines()]
    assert len({(line.get_color(), str(line._unscaled_dash_pattern)) for line in lines}) == 6
    assert len({str(line._unscaled_dash_pattern) for line in lines}) == 6  # in grey too
    assert [line.get_color() for line in lines[::2]] == [line.get_color() for line in lines[1::2]]  # of both runs
    assert [text.get_text() for text in sheet.legends[0].get_texts()][:2] == ["rail.fy, a", "rail.fy, b"]


def test_a_legend_covers_no_plot():
    sheet = drawn(stiffmbs.run(EXAMPLES / "cart_pendulum.yaml", duration=1), None)
    sheet.canvas.draw()
    legend, plot = sheet.legends[0].get_window_extent(), sheet.axes[0].get_window_extent()
    assert legend.y1 <= plot.y0


@pytest.mark.long
def test_plots_are_written_of_scenes_and_of_results(tmp_path):
    results = tmp_path / "r.npz"
    stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.5).save(results)
    one = run("plot", results, "hinge.fy", "bar.x", "--against", "bar.angle", "-o", tmp_path / "a.svg", "--json")
    assert json.loads(one.output)["against"] == "bar.angle"
    two = run("plot", EXAMPLES / "bar_pendulum.yaml", "--duration", 0.5, "--with", results, "-o", tmp_path / "b.png")
    assert (one.exit_code, two.exit_code) == (0, 0), two.output
    assert (tmp_path / "a.svg").read_text().startswith("<?xml") and (tmp_path / "b.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("hinge.fq", "-o", "x.svg"), "found no channel 'hinge.fq', expected one such as hinge.fx"),
        (("-o", "x.gif"), "found the ending '.gif'"),
        (("--live", "-o", "x.svg"), "--live: found -o, expected a scene alone"),
        ((), "found no screen for a window, expected -o FILE"),
    ],
)
def test_wrong_plots_are_told(tmp_path, monkeypatch, arguments, words):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    result = run("plot", EXAMPLES / "bar_pendulum.yaml", *arguments)
    assert result.exit_code == 2
    assert words in result.stderr


def test_results_cannot_be_solved_again(tmp_path):
    stiffmbs.run(EXAMPLES / "bar_pendulum.yaml", duration=0.1).save(tmp_path / "r.npz")
    result = run("plot", tmp_path / "r.npz", "bar.x", "--rtol", "1e-8", "-o", tmp_path / "x.png")
    assert result.exit_code == 2
    assert "found results with --run.rtol, expected a scene to solve" in result.stderr


def test_a_film_of_nothing_that_moves_is_refused():
    with pytest.raises(InputError, match="--rate: found nan"):
        stiffmbs.animate(EXAMPLES / "four_bar.yaml", "x.gif", rate=float("nan"))


@pytest.mark.long
@pytest.mark.parametrize("speed", [pytest.param(0.0, marks=pytest.mark.long), 50.0])
def test_a_film_goes_with_a_mechanism_that_travels(speed):
    """At 50 m/s a body of half a metre would be a dot of the film; it fills as much of it as one at rest."""
    model = stiffmbs.Model(gravity=(0, 0))
    model.add("box", stiffmbs.Body(mass=1, inertia=0.1, velocity=(speed, 0)))
    scene = stiffmbs.read_scene(model.to_scene())
    solution = stiffmbs.run(scene, duration=1.0, points=11)
    poses = poses_of(scene, solution.time, solution.channels)
    drawing = drawing_of(scene)
    assert followed_body(drawing, poses) == ("box" if speed else "")
    *_, last = pictures(
        drawing, {"": poses}, view_named("", 2, drawing.gravity), Playback(rate=5), Shown(False, False), []
    )
    assert (np.ptp(last.astype(int), axis=2) > 40).sum() > 10_000
