"""The summary of a run: labels and values, the largest loads, numbered notes."""

import io
from dataclasses import replace

import numpy as np
import pytest

import stiffmbs
from stiffmbs.results.error_bars import ErrorBar
from stiffmbs.show.escaped import console
from stiffmbs.show.force_table import force_rows, rich_table
from stiffmbs.show.plain import PlainConsole
from stiffmbs.show.summary import INDENT, print_summary

LINKS = 14
RUN_WITH_A_SHARP_PEAK = """
gravity: [0, -9.81]
bodies: {bar: {mass: 1.2, inertia: 0.036, position: [0.3, 0]}}
joints: {hinge: {type: revolute, i: {body: bar, point: [-0.3, 0]}, j: ground}}
run: {duration: 1, points: 8, rtol: 1e-8}
"""


@pytest.fixture(scope="module")
def chain():
    """A hanging chain, whose first joint carries most, and a setting that the solver does not read."""
    bodies = {f"b{k}": {"mass": 1, "inertia": 1, "position": [0, -k]} for k in range(LINKS)}
    joints = {"j0": {"type": "revolute", "i": "b0", "j": "ground"}} | {
        f"j{k}": {"type": "revolute", "i": f"b{k}", "j": {"body": f"b{k - 1}", "point": [0, -1]}}
        for k in range(1, LINKS)
    }
    scene = {"gravity": [0, -9.81], "bodies": bodies, "joints": joints}
    model = stiffmbs.read_scene(str(scene))
    return stiffmbs.run(
        model, duration=0.1, points=3, solver="projected", scheme="rk4", step=0.01, rtol=1e-5, errors=False
    )


def printed(solution, width, all=False):
    file = io.StringIO()
    print_summary("scene", solution, "out.npz", console(file=file, width=width), all)
    return file.getvalue().splitlines()


def test_the_ten_largest_loads_are_listed_in_the_order_of_the_scene(chain):
    lines = printed(chain, 200)
    (head,) = [line for line in lines if line.startswith("force and torque")]
    assert f"the 10 largest of {LINKS} (--all shows all)" in head
    assert [line.split()[1] for line in lines if line.startswith("│")] == [f"j{k}" for k in range(10)]


def test_requests_have_lines_with_their_ranges_bars_and_units():
    scene = stiffmbs.read_scene("""
gravity: [0, -9.81]
bodies: {bar: {mass: 1.2, inertia: 0.036, position: [0.3, 0]}}
joints: {hinge: {type: revolute, i: {body: bar, point: [-0.3, 0]}, j: ground}}
requests: {load: fm(hinge), turn: az(bar)}
units: {angle: deg}
run: {duration: 0.5, points: 501, rtol: 1e-8}
""")
    lines = stiffmbs.run(scene).summary().splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("requests"))
    load, turn = (line[INDENT:].split() for line in lines[start : start + 2])
    assert load[0] == "load:" and (load[-1], turn[-1]) == ("N", "deg")
    assert float(load[-4]) == pytest.approx(29.43, abs=1e-2) and load[-3] == "\N{PLUS-MINUS SIGN}"
    assert lines[start + 1].startswith(" ")


def test_a_verified_run_has_the_line_of_its_errors():
    found = stiffmbs.verify(stiffmbs.read_scene(RUN_WITH_A_SHARP_PEAK))
    (line,) = [line for line in found.summary().splitlines() if line.startswith("errors")]
    assert (
        "positions to" in line
        and "peaks between output times: up to" in line
        and "less with a shorter output interval" in line
    )


def test_all_loads_are_listed_when_asked_for(chain):
    lines = printed(chain, 200, all=True)
    assert [line.split()[1] for line in lines if line.startswith("│")] == [f"j{k}" for k in range(LINKS)]
    assert chain.summary(all=True).count("\n│") == LINKS and chain.summary().count("\n│") == 10


def test_notes_are_numbered_and_lines_have_labels(chain):
    lines = printed(chain, 1000)
    labels = [line[:INDENT].strip() for line in lines if line[:1].isalpha()]
    assert [label for label in labels if label in ("energy", "constraints", "solver", "steps", "cost", "notes", "results")] == [
        "energy", "constraints", "solver", "steps", "cost", "notes", "results",
    ]  # fmt: skip
    (note,) = [line for line in lines if line.startswith("notes")]
    assert note[INDENT:].startswith("1. rtol = 1e-05 has no effect")
    assert lines[-1] == "results      out.npz"


@pytest.mark.parametrize("width", [40, 80])
def test_long_lines_are_wrapped_below_their_values(chain, width):
    values, unbroken = (_below_the_table(printed(chain, each)) for each in (width, 1000))
    assert all(len(line) <= width for line in values)
    assert any(line.startswith(" " * INDENT) for line in values)
    words, expected = (" ".join(line[INDENT:] for line in lines).split() for lines in (values, unbroken))
    assert words == expected


def _below_the_table(lines):
    return lines[next(k for k, line in enumerate(lines) if line.startswith("energy")) :]


@pytest.mark.parametrize(("part", "is_zero"), [(0.7e-11, True), (1.5e-11, False)])
def test_a_force_of_rounding_is_shown_as_zero(chain, part, is_zero):
    """Below 1e-11 of the largest force."""
    largest = max(np.abs(chain[name]).max() for name in chain if name.endswith((".fx", ".fy", ".torque")))
    element = {
        f"b.{label}": np.full(len(chain.time), value)
        for label, value in (("fx", part * largest), ("fy", 0), ("torque", 0))
    }
    table = io.StringIO()
    console(file=table, width=200).print(
        rich_table(*force_rows(replace(chain, channels={**chain.channels, **element})))
    )
    (row,) = [line for line in table.getvalue().splitlines() if line.startswith("│ b ")]
    assert (row.split("│")[2].strip() == "0 .. 0") == is_zero


def test_a_file_gets_the_lines_that_rich_writes(chain):
    """Without loading rich, which takes longer than printing; also with error bars, on two lines of a cell."""
    barred = replace(
        chain,
        errors={name: ErrorBar(1e-3, 2e-3, 3e-3, 2e-3, 3e-3) for name in chain.channels},
        not_unique=("j3.fx",),
        name="±",
    )
    for solution in (chain, barred):
        plain = io.StringIO()
        print_summary("scene", solution, "out.npz", PlainConsole(plain, 1000), all=True)
        assert plain.getvalue().splitlines() == printed(solution, 1000, all=True)
