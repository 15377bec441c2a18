"""Images of tables: complete, relocated in the same process, and equal to the tables to the last bit."""

import gc
import sys
from pathlib import Path

import numpy as np
import pytest

from stiffmbs.analyses.job import prepare
from stiffmbs.compile.machine.image import image_of
from stiffmbs.compile.machine.layout import FLOATS, INT, INTS, Layout, Table, address, packed
from stiffmbs.compile.machine.native.tables import FACTORS
from stiffmbs.solve.explicit.integration import Integration
from stiffmbs.solve.explicit.scheme import ADVANCE
from stiffmbs.solve.explicit.schemes import DOP853

from ..conftest import EXAMPLE_SCENES

STEPS, HELD = 100_000, 2**40
"""More steps than a run takes, and more that stability limits."""


def started(name):
    """Integration of a scene at its start, without pivots, and its image."""
    job = prepare(EXAMPLE_SCENES[name], presolve=False)
    work = Integration.of(DOP853, job.dynamics, job.start, job.grid, job.settings, 64)
    work.step_bound.follow(job.dynamics.input_features(job.grid.start, job.grid.end))
    job.dynamics.forget_pivots()
    return job, work, image_of([work.table])


def mapped(words):
    """The words that are addresses of memory of this process."""
    ranges = [line.split()[0].split("-") for line in Path("/proc/self/maps").read_text().splitlines()]
    first, end = (np.array([int(each[k], 16) for each in ranges if int(each[k], 16) < 2**63]) for k in range(2))
    place = np.searchsorted(first, words, "right") - 1
    return (place >= 0) & (words < end[np.maximum(place, 0)])


@pytest.mark.parametrize("name", ["cart_pendulum", "half_car", "bouncing_ball", "stick_slip", "spatial_slider_crank"])
def test_steps_in_an_image_are_equal_to_the_last_bit(name):
    job, work, image = started(name)
    words, end, at = image.relocated(), 0.5 * (job.grid.start + job.grid.end), image.at(work.table)
    status = ADVANCE.call(end, STEPS, HELD, False, address(work.table))
    place, n, expected = image.at(work.y) // 8, len(work.y), work.y.copy()
    del job, work, image
    gc.collect()  # an instance needs the code alone
    assert ADVANCE.call(end, STEPS, HELD, False, words.ctypes.data + at) == status
    np.testing.assert_array_equal(words.view(np.float64)[place : place + n], expected)


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc/self/maps")
@pytest.mark.parametrize("name", ["cart_pendulum", "stick_slip", "spatial_slider_crank", "car"])
def test_an_image_contains_no_address(name):
    _, _, image = started(name)
    assert not mapped(np.frombuffer(image.content, dtype=np.int64)).any()
    relocated = image.relocated()
    assert mapped(relocated).sum() >= len(image.links) + len(image.calls)


def test_own_arrays_are_stored_empty():
    job, _, image = started("cart_pendulum")
    assert job.dynamics.accelerate(0.0)[0] == 0  # factors of the tables
    table = job.dynamics._accelerations.factors_table
    cells = table.view(FACTORS.cells)[0]
    assert cells["capacity"] and cells["ready"]
    alone = image_of([table])
    again = alone.relocated()[alone.at(table) // 8 :][: len(FACTORS)].view(FACTORS.cells)[0]
    assert not (again["capacity"] or again["ready"])
    assert image.n_owned and len(image.own) == image.n_owned * 3 // 2  # four arrays and two cells of each


OUTER = Layout({"inner": INTS, "values": FLOATS, "n": INT})
INNER = Layout({"first": FLOATS, "n": INT})


def test_arrays_of_one_block_keep_their_places():
    block, empty = np.arange(12.0), np.empty(0)
    inner = packed(INNER, {"first": block[8:], "n": 3})
    outer = packed(OUTER, {"inner": inner, "values": block[:4], "n": 1})
    image = image_of([outer], [block])
    words = image.relocated()
    words.view(np.float64)[image.at(block[8:]) // 8] = 50.0
    assert image.at(block[8:]) - image.at(block[:4]) == 64
    assert words[image.cell(outer, "inner") // 8] == words.ctypes.data + image.at(inner)
    assert words[image.cell(inner, "n") // 8] == 3 and block[8] == 8.0
    assert image_of([packed(INNER, {"first": empty, "n": 0})]).content == b""


def test_rows_of_a_table_keep_their_links():
    table = Table(INNER, 3)
    arrays = [np.full(2, float(k)) for k in range(3)]
    for k, array in enumerate(arrays):
        table.put_row(k, {"first": array, "n": 10 * k})
    chosen, same = table.rows(np.array([2, 0])), table.same()
    assert chosen.tolist() == [address(arrays[2]), 20, address(arrays[0]), 0]
    assert [chosen.links[k] is array for k, array in ((0, arrays[2]), (2, arrays[0]))] == [True, True]
    same.link("first", arrays[2])
    assert table.links[0] is arrays[0] and same.links[0] is arrays[2] and same[2:].tolist() == table[2:].tolist()
