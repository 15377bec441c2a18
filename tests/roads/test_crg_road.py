"""Roads by OpenCRG files: heights beside straight and curved reference lines, in all formats, and what is wrong with such files."""

import math
import struct

import numpy as np
import pytest

from stiffmbs import InputError, load_scene, run
from stiffmbs.roads import CrgRoad
from stiffmbs.spatial import VerticalTyre

from ..tyres.wheels import reported, wheel

pytestmark = pytest.mark.long  # kernels that no other test compiles, or many scenes

STEP, COUNT, SECTIONS = 0.1, 400, (-2.0, -0.5, 0.5, 3.0)
BEND, HEADING = 1 / 40, 0.4
"""Curvature of the reference line, 1/m, and its heading at the start, rad."""


def height(u, v):
    """Of the road of the files: linear across, so that straight lines between sections are exact."""
    return 2.0 + 0.02 * u + 0.03 * np.sin(u / 4) + v * (0.04 + 0.01 * np.cos(u / 6))


def line(u, bend):
    """The reference line as arcs, with the middle of each stretch in its heading."""
    steps = HEADING + bend * (u[1:] - STEP / 2)
    x = 10 + np.concatenate([[0], np.cumsum(np.cos(steps) * STEP)])
    return np.concatenate([[np.nan], steps]), x, -4 + np.concatenate([[0], np.cumsum(np.sin(steps) * STEP)])


def written(path, layout="KDBI", bend=BEND, change=None):
    """A file with banking 0.04 and slope 0.02 as channels, and the rest of the heights in its long sections."""
    u, v = STEP * np.arange(COUNT), np.array(SECTIONS)
    phi, *_ = line(u, bend)
    own = height(u[:, None], v) - 2.0 - 0.02 * u[:, None] - 0.04 * v
    records = np.column_stack([phi, np.full(COUNT, 0.02), np.full(COUNT, 0.04), own])
    if change is not None:
        change(records)
    channels = ["reference line phi,rad", "reference line slope,m/m", "reference line banking,m/m"]
    channels += [f"long section at v = {each},m" for each in SECTIONS]
    head = [
        "$CT ! comment", "a road", "$", "$ROAD_CRG", "* where it begins", "reference_line_start_u = 0.0 ! m",
        f"REFERENCE_LINE_INCREMENT = {STEP}", "REFERENCE_LINE_START_X = 10", "REFERENCE_LINE_START_Y = -4",
        "REFERENCE_LINE_START_Z = 2", "$", "$KD_DEFINITION", f"#:{layout}", f"U:reference line u,m,0,{STEP}",
        *(f"D:{channel}" for channel in channels), "$", "$$$$$$$$",
    ]  # fmt: skip
    path.write_bytes("\n".join(head).encode() + b"\n" + data(records, layout))
    return path


def data(records, layout):
    if layout in ("KRBI", "KDBI"):
        letter, size = ("f", 4) if layout == "KRBI" else ("d", 8)
        content = struct.pack(f">{records.size}{letter}", *records.ravel())
        return content + struct.pack(f">{letter}", math.nan) * (-len(content) % 80 // size)
    width, shown = (10, "{:10.7f}") if layout == "LRFI" else (20, "{:20.13e}")
    lines = []
    for record in records:
        text = "".join("*" * width if np.isnan(x) else shown.format(x)[:width] for x in record)
        lines += [text[k : k + 80] for k in range(0, len(text), 80)]
    return "\n".join(lines).encode() + b"\n"


def error_at(road, x, y, z):
    """How far above z, m, a wheel finds the road that is so small that slopes don't count."""
    model = wheel(VerticalTyre(i="wheel", radius=1e-4, stiffness=1e5, road=road), 1e-4, speed=0.0)
    body = model.bodies["wheel"]
    model.bodies["wheel"] = body.model_copy(update={"position": (x, y, z + 5e-5)})
    return reported(model)["deflection"] - 5e-5


PLACES = [(3.05, 0.2), (11.3, -1.7), (20.0, 2.9), (33.7, -0.5), (39.0, 1.0)]


@pytest.mark.sampled(3)
@pytest.mark.parametrize(("layout", "bend"), [("KRBI", BEND), ("KDBI", 0.0), ("LRFI", 0.0), ("LDFI", BEND)])
def test_heights_beside_the_reference_line(tmp_path, layout, bend):
    road = CrgRoad(file=written(tmp_path / "road.crg", layout, bend), placed="file")
    u, x, y = STEP * np.arange(COUNT), *line(STEP * np.arange(COUNT), bend)[1:]
    for along, v in PLACES:
        heading = HEADING + bend * along
        at = np.interp(along, u, x) - v * math.sin(heading), np.interp(along, u, y) + v * math.cos(heading)
        assert error_at(road, *at, height(along, v)) == pytest.approx(0, abs=2e-5)


@pytest.mark.parametrize("bend", [BEND, 0.0])
def test_drawn_points_lie_on_the_road(tmp_path, bend):
    road = CrgRoad(file=written(tmp_path / "road.crg", bend=bend), placed="file")
    u = STEP * np.arange(COUNT)
    points = road.surface_points(COUNT)
    np.testing.assert_allclose(points[..., 2], height(u[:, None], np.array(SECTIONS)), atol=1e-6)
    _, x, y = line(u, bend)
    heading = HEADING + bend * u
    for k, v in enumerate(SECTIONS):
        np.testing.assert_allclose(points[2:-2, k, 0], (x - v * np.sin(heading))[2:-2], atol=0.01)
        np.testing.assert_allclose(points[2:-2, k, 1], (y + v * np.cos(heading))[2:-2], atol=0.01)
    assert len(road.surface_points(50)) <= 50


def test_a_road_begins_at_the_origin_along_x(tmp_path):
    """As OpenCRG places a file that says nothing else; x and y from the circle's own centre."""
    road = CrgRoad(file=written(tmp_path / "road.crg"))
    begin = BEND * STEP / 2  # the heading of the first stretch is that of its middle
    for along, v in PLACES:
        turn, radius = BEND * along, 1 / BEND - v
        x, y = radius * math.sin(turn), 1 / BEND - radius * math.cos(turn)
        at = x * math.cos(begin) + y * math.sin(begin), y * math.cos(begin) - x * math.sin(begin)
        assert error_at(road, *at, height(along, v) - 2.0) == pytest.approx(0, abs=1e-4)


def test_beyond_its_ends_and_edges_the_height_stays(tmp_path):
    road = CrgRoad(file=written(tmp_path / "road.crg", bend=0.0))
    assert error_at(road, -5.0, 0.5, height(0.0, 0.5) - 2.0) == pytest.approx(0, abs=1e-6)
    assert error_at(road, 20.0, 7.0, height(20.0, 3.0) - 2.0) == pytest.approx(0, abs=1e-6)


def test_numbered_sections_and_those_that_are_used(tmp_path):
    count = 9
    head = "$ROAD_CRG\nreference_line_increment=1\nlong_section_v_increment=0.05\n$\n$KD_DEFINITION\n#:LRFI\n"
    channels = "".join(f"D:long section {k + 1},m\n" for k in range(count))
    row = "\n".join("".join(f"{0.001 * k:10.5f}" for k in range(a, min(a + 8, count))) for a in range(0, count, 8))
    (tmp_path / "wide.crg").write_text(f"{head}{channels}$\n$$$$\n" + f"{row}\n" * 5)
    road = CrgRoad(file=tmp_path / "wide.crg", sections=4)
    assert road.file.v[[0, -1]] == pytest.approx([-0.2, 0.2])
    assert error_at(road, 2.0, 0.03, 0.001 * (0.2 + 0.03) / 0.05) == pytest.approx(0, abs=1e-6)
    assert list(road.notes()) == [f"4 of the 9 long sections of {tmp_path / 'wide.crg'} are used"]


SCENE = """
dimensions: 3
gravity: [0, 0, -9.81]
roads: {bend: {type: crg, file: road.crg, FILTER}}
bodies: {wheel: {mass: 100, inertia: [1, 1, 1], position: [5, 0.2, 0.43], velocity: [8, 2, 0]}}
forces: {tyre: {type: vertical_tyre, i: wheel, radius: 0.3, stiffness: 1e5, damping: 2000, road: bend}}
joints: {upright: {type: orientation, i: wheel, j: ground}}
run: {duration: 1.5, output: 10 ms, rtol: 1e-8}
"""


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("bend", "filtered"),
    [
        (0.0, ""),
        pytest.param(BEND, "", marks=pytest.mark.long),
        pytest.param(BEND, "filter_radius: 300 mm", marks=pytest.mark.long),
    ],
)
def test_a_mass_slides_along_a_road(tmp_path, bend, filtered):
    """Two integrators with nothing in common find the same motion, one of them with all derivatives of the road."""
    written(tmp_path / "road.crg", bend=bend)
    (tmp_path / "scene.yaml").write_text(SCENE.replace("FILTER", filtered or "friction: 1"))
    found = [run(load_scene(tmp_path / "scene.yaml", [("run.solver", s)])) for s in ("bdf", "projected")]
    assert all(each.success for each in found)
    for channel in ("wheel.x", "wheel.y", "wheel.z"):
        assert np.abs(found[0][channel] - found[1][channel]).max() < 2e-5
    assert found[0]["wheel.z"][-1] > found[0]["wheel.z"][0] + 0.1  # up the slope


def gap(records):
    records[7, 4] = math.nan


@pytest.mark.parametrize(
    ("layout", "change", "old", "new", "said"),
    [
        ("KDBI", gap, b"", b"", r"cross-section 8: found no number for 'long section at v = -0.5' at u = 0.7 m"),
        ("LDFI", gap, b"", b"", r"line 39: found no number for 'long section at v = -0.5'"),
        ("KDBI", None, b"#:KDBI", b"#:KXBI", "line 13: found the format 'KXBI', expected LRFI"),
        ("KDBI", None, b"slope,m/m", b"slope,deg", "line 16: found 'reference line slope' in 'deg', expected m/m"),
        ("KDBI", None, b"at v = 3.0", b"at v = wide", "line 21: found the long section"),
        ("KDBI", None, b"at v = 3.0", b"4", "line 21: found 'long section 4', expected positions for all or none"),
        ("KDBI", None, b"at v = 3.0", b"at v = 0.5", "found two long sections at one v"),
        ("KDBI", None, b"_START_X = 10", b"_START_X = ten", "line 8: found 'ten', expected a number"),
        ("KDBI", None, b"$CT ! comment", b"$ROAD_CRG_MODS", "line 2: found .ROAD_CRG_MODS, modifiers"),
        ("KDBI", None, b"$$$$$$$$", b"", "found no line .... that ends the header"),
        ("KDBI", None, b"$\n$$$$$$$$", b"$$$$$$$$", "line 22: found the end of the header inside .KD_DEFINITION"),
        ("LDFI", None, b"e-02\n", b"e-x2\n", "expected a number of [0-9]+ characters"),
    ],
)
def test_faults_are_told_with_their_place(tmp_path, layout, change, old, new, said):
    path = written(tmp_path / "road.crg", layout, change=change)
    path.write_bytes(path.read_bytes().replace(old, new, 1))
    with pytest.raises(InputError, match=said):
        CrgRoad(file=path)


def test_roads_that_turn_too_far_or_fold_are_refused(tmp_path):
    with pytest.raises(InputError, match="deg off its mean direction"):
        CrgRoad(file=written(tmp_path / "turn.crg", bend=0.1))
    with pytest.raises(InputError, match=r"nowhere\.crg: found no such file"):
        CrgRoad(file="nowhere.crg")


def test_a_straight_road_leads_from_its_start_to_its_end(tmp_path):
    head = "$ROAD_CRG\nreference_line_increment=1\nreference_line_start_x=1\nreference_line_end_x=4\nreference_line_end_y=3\n{}$\n"
    rest = (
        "$KD_DEFINITION\n#:LRFI\nD:long section at v = -1,m\nD:long section at v = 1,m\n$\n$$$$\n"
        + "   0.00000   0.00000\n" * 5
    )
    file = tmp_path / "straight.crg"
    file.write_text(head.format("") + rest)
    grid = CrgRoad(file=file, placed="file").file
    np.testing.assert_allclose(grid.heading, math.pi / 4)
    np.testing.assert_allclose(grid.x, 1 + np.arange(5) / math.sqrt(2))
    file.write_text(head.format("reference_line_start_phi=0.5\n") + rest)
    with pytest.raises(
        InputError, match=r"START_PHI = 0\.5, but the reference line leads from its start to its end at 0\.785 rad"
    ):
        CrgRoad(file=file)


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        ("reference_line_end_s=0.1", r"END_S = 0\.1, expected 0\.05, the slope at the end"),
        ("reference_line_end_b=0.02", r"END_B = 0\.02, expected 0, the banking"),
        ("reference_line_end_z=1", r"END_Z = 1, expected 0\.2, the level"),
    ],
)
def test_a_header_that_contradicts_itself_at_the_end_is_refused(tmp_path, stated, said):
    head = "$ROAD_CRG\nreference_line_increment=1\nreference_line_start_s=0.05\n{}\n$\n"
    rest = (
        "$KD_DEFINITION\n#:LRFI\nD:long section at v = -1,m\nD:long section at v = 1,m\n$\n$$$$\n"
        + "   0.00000   0.00000\n" * 5
    )
    file = tmp_path / "sloping.crg"
    file.write_text(head.format("reference_line_end_s=0.05\nreference_line_end_b=0\nreference_line_end_z=0.2") + rest)
    np.testing.assert_allclose(CrgRoad(file=file).file.heights[:, 0], 0.05 * np.arange(5))
    file.write_text(head.format(stated) + rest)
    with pytest.raises(InputError, match=said):
        CrgRoad(file=file)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("$CT", "$ROAD_CRG_MPRO\nmap = 1\n$\n$CT", "not used: block ROAD_CRG_MPRO"),
        ("$CT", "$OTHER\nx\n$\n$CT", "not used: block OTHER"),
        ("REFERENCE_LINE_START_Z = 2", "REFERENCE_LINE_START_Z = 2\nREFERENCE_LINE_OFFSET_Z = 0.5", "[ROAD_CRG] REFERENCE_LINE_OFFSET_Z"),
        ("REFERENCE_LINE_START_Z = 2", "REFERENCE_LINE_START_Z = 2\nREFERENCE_LINE_START_LON = 11", "REFERENCE_LINE_START_LON"),
        ("REFERENCE_LINE_START_Z = 2", "REFERENCE_LINE_START_Z = 2\nREFERENCE_LINE_OFFSET_Z = 0", ""),
        ("REFERENCE_LINE_START_Z = 2", "REFERENCE_LINE_START_Z = 2\nLONG_SECTION_V_LEFT = 3", ""),
        ("$CT", "$ROAD_CRG_OPTS\nBORDER_MODE_U = 2\n$\n$CT", "the options of"),
        ("reference line slope", "reference line slope", ""),
    ],
)  # fmt: skip
def test_what_a_file_says_and_nothing_uses_is_noted(tmp_path, old, new, said):
    path = written(tmp_path / "road.crg")
    content = path.read_bytes()
    assert old.encode() in content
    path.write_bytes(content.replace(old.encode(), new.encode(), 1))
    notes = "; ".join(CrgRoad(file=path).notes())
    assert said in notes if said else not notes
