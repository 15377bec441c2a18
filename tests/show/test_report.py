"""The page on a run holds what there is to say, and needs nothing besides."""

import base64
import re
from html.parser import HTMLParser
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from stiffmbs import load_scene, read_scene, run
from stiffmbs.commands.main import main
from stiffmbs.results.provenance import provenance_of
from stiffmbs.show.sections import changed_values, energy_section
from stiffmbs.verification import verify

from ..conftest import EXAMPLES

pytest.importorskip("jinja2")
pytest.importorskip("matplotlib")


def stiffmbs(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


class Page(HTMLParser):
    """Texts, headings and addresses of a page; tags must be closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.texts, self.addresses, self.headings = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.addresses += [value for name, value in attributes if name in ("src", "href")]
        if tag not in ("meta", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append(data.strip())
        if self.open and self.open[-1] == "h2":
            self.headings.append(data)


@pytest.fixture
def page_of(tmp_path):
    def make(scene, *options):
        path = tmp_path / "page.html"
        result = stiffmbs("report", EXAMPLES / f"{scene}.yaml", "-o", path, *options)
        assert result.exit_code == 0, result.output
        return Page(path.read_text(encoding="utf-8"))

    return make


def test_the_energies_of_dampers_stand_in_a_table(page_of):
    page = page_of("door")
    assert "Energy of the elements" in page.headings
    assert "stored, J" in (text := "\n".join(page.texts)) and "24.66" in text


def test_rounding_of_the_energy_of_the_motion_is_no_energy_of_an_element():
    """A car that drives at constant speed: its tyre does some 1e-13 J of work, of 7e4 J."""
    scene = load_scene(EXAMPLES / "vehicles" / "quarter_car.yaml")
    assert energy_section(run(scene, duration=0.15)) is None


@pytest.mark.long
def test_a_page_holds_check_peaks_figures_and_settings(page_of):
    page = page_of("cart_pendulum", "--rtol", "1e-7")
    assert page.headings == [
        "Loads", "Motion", "Figure of the scene", "Notes", "How this was computed", "Verification", "Check",
        "Peaks of all channels", "Solver", "Settings", "Scene and command of this page",
    ]  # fmt: skip
    assert not page.open
    text = "\n".join(page.texts)
    for part in (
        "2 degrees of freedom",
        "presolve:",
        "rail.fy",
        "\u00b1",
        "rerun with bdf at rtol 1e-09",
        "steps",
        "1e-07",
    ):
        assert part in text


@pytest.mark.long
def test_a_page_needs_nothing_from_elsewhere(page_of):
    page = page_of("cart_pendulum", "--duration", "2")
    assert len(page.addresses) == 1  # steps of the solver
    for address in page.addresses:
        kind, content = re.fullmatch(r"data:image/([a-z+]+);base64,(.*)", address).groups()
        image = base64.b64decode(content)
        assert image[:4] == b"\x89PNG" if kind == "png" else ElementTree.fromstring(image).tag.endswith("svg")


@pytest.mark.long
def test_a_run_is_not_verified_where_one_says_so(page_of):
    page = page_of("bar_pendulum", "--no-verify")
    assert "not verified: peaks have the error bars that the run estimated" in page.texts
    page = page_of("bar_pendulum", "--no-verify", "--set", "run.errors=false")
    assert "not verified: peaks have no error bars" in page.texts
    assert not any("\u00b1" in text for text in page.texts)


@pytest.mark.parametrize("completed", [0, 1])
def test_an_interrupted_verification_claims_no_agreement(completed, tmp_path, monkeypatch):
    """Peaks have error bars if a rerun was completed before."""
    reruns = iter([verify.solve_again] * completed)

    def interrupted(*arguments):
        rerun = next(reruns, None)
        if rerun is None:
            raise KeyboardInterrupt
        return rerun(*arguments)

    monkeypatch.setattr(verify, "solve_again", interrupted)
    path = tmp_path / "page.html"
    result = stiffmbs("report", EXAMPLES / "bar_pendulum.yaml", "-o", path, "--duration", "0.1")
    assert result.exit_code == 1, result.output
    text = "\n".join(Page(path.read_text(encoding="utf-8")).texts)
    assert "verification interrupted by the user" in text
    assert "reruns agree" not in text
    assert ("rerun with" in text) == ("\u00b1" in text) == bool(completed)


@pytest.mark.long
def test_the_verdict_stands_first(page_of):
    page = page_of("cart_pendulum", "--duration", "2")
    text = "\n".join(filter(None, page.texts))
    found = re.search(r"Reliable\nThe largest force is [\d.]+ ± [\d.]+ N, in rail at [\d.]+ s\.", text)
    digits = re.search(r"Positions are known to \d+ digits, velocities to \d+, forces to \d+\.", text)
    assert found and digits and found.start() < digits.start() < text.index("Loads") < text.index("Solver")


@pytest.mark.sampled(2)
@pytest.mark.long
@pytest.mark.parametrize("as_results", [False, True])
def test_two_runs_are_compared_differences_first(tmp_path, as_results):
    """The mass of a ball that falls differs: its force does, its motion does not."""
    text = "gravity: [0, -10]\nbodies: {ball: {mass: %s, inertia: 1}}\nforces: {hold: {type: force, i: ball, force: [0, %s]}}\nrun: {duration: 1, points: 11}\n"
    (tmp_path / "a.yaml").write_text(text % (2, 8))
    (tmp_path / "b.yaml").write_text(text % (1, 4))
    other = tmp_path / "b.yaml"
    if as_results:
        other = tmp_path / "b.npz"
        assert stiffmbs("run", tmp_path / "b.yaml", "-o", other).exit_code == 0
    result = stiffmbs("report", tmp_path / "a.yaml", other, "-o", tmp_path / "page.html", "--no-verify")
    assert result.exit_code == 0, result.output
    page = Page((tmp_path / "page.html").read_text(encoding="utf-8"))
    assert page.headings[0] == f"Differences from {other.name}" and page.headings[1] == "Loads"
    assert "hold.fy" in page.texts and "ball.y" not in page.texts[: page.texts.index("Motion")]
    texts = [text for text in page.texts if text]
    for row in (
        ["bodies.ball.mass", "2", "1"], ["hold", "8", "4", "+100 %", "N"], ["hold.fy", "4", "1", "N", "0", "8", "4"],
    ):  # fmt: skip
        place = texts.index(row[0])
        assert texts[place : place + len(row)] == row


@pytest.mark.long
def test_what_is_in_doubt_stands_first(page_of):
    page = page_of("cam_follower")
    doubt = next(k for k, text in enumerate(page.texts) if "sensitive" in text or "error bars of peaks" in text)
    assert doubt < page.texts.index("Check")


@pytest.mark.long
def test_names_are_no_markup(tmp_path):
    scene = tmp_path / "odd.yaml"
    scene.write_text(
        "name: <b>bold & brash</b>\nbodies: {ball: {mass: 1, inertia: 1}}\nrun: {duration: 0.1, points: 11}\n"
    )
    result = stiffmbs("report", scene, "-o", tmp_path / "odd.html")
    assert result.exit_code == 0, result.output
    assert "&lt;b&gt;bold &amp; brash&lt;/b&gt;" in (tmp_path / "odd.html").read_text()


@pytest.mark.parametrize(
    ("scene", "output", "part"),
    [
        (EXAMPLES / "cart_pendulum.yaml", "page.pdf", "expected .html"),
        (EXAMPLES / "cart_pendulum.yaml", "nowhere/page.html", "found no folder"),
        ("missing.yaml", "page.html", "missing.yaml"),
        (f"{EXAMPLES / 'cart_pendulum.yaml'} missing.npz", "page.html", "missing.npz"),
    ],
)
def test_wrong_input_gets_one_sentence(scene, output, part, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = stiffmbs("report", *str(scene).split(" "), "-o", output)
    assert result.exit_code == 2
    assert part in result.output and "Traceback" not in result.output
    assert not list(tmp_path.iterdir())


@pytest.mark.long
def test_a_car_s_page_has_its_axles_and_the_loads_of_its_bushings(page_of):
    page = page_of("vehicles/bushing_axle", "--no-verify", "--duration", "0.1", "--kc", "", "--kc", "middle", "--loads")
    assert "Kinematics and compliance: left and right" in page.headings
    assert "Kinematics and compliance: middle" in page.headings and "Road loads" in page.headings
    assert any("axle 'middle': found 0 wheels" in text for text in page.texts)
    for text in ("wheel_rate", "left.lower.front_bush"):
        assert text in page.texts


def test_changed_parameters_of_a_part_are_compared_with_its_definition():
    text = """
dimensions: 3
bodies: {chassis: {mass: 1000, inertia: [300, 900, 900]}}
parts: {front.bar: {use: anti_roll_bar, on: chassis, mounts: {left: chassis, right: chassis}, parameters: {damping: 2}}}
"""
    changes = [("parts.front.bar.parameters.stiffness", "1500"), ("parts.front.bar.parameters.link_z", "0.2")]
    own, other = (provenance_of(read_scene(text, given)) for given in (changes, []))
    assert [*changed_values(own, other)] == [
        ("use.front.bar.parameters.stiffness", "1500", "700 N m/rad"),
        ("use.front.bar.parameters.link_z", "0.2", "0.19 m"),
    ]
