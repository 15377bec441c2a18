"""Entries of a matrix in the order in which compiled code adds them up."""

import numpy as np
import pytest

from stiffmbs.compile.entry_order import ordered_entries


def added_up(slot, values, constant, cj, found, at_cj, n_slots):
    """As `stiffmbs.compile.machine.native.evaluate.add_entries`, in memory that holds no numbers at first."""
    slot, values, constant, cj = (part[found.order] for part in (slot, values, constant, cj))
    a = np.full(n_slots, np.nan)
    a[: found.n_cleared] = 0.0
    a[found.bare] = 0.0
    for k in range(len(slot)):
        term = values[k] * (constant[k] + (cj[k] * at_cj if k >= found.n_constant else 0.0))
        a[slot[k]] = term if k < found.n_first else a[slot[k]] + term
    return a


@pytest.mark.parametrize(("n_slots", "count"), [(40, 150), (40, 30), (300, 60), (5, 0)])
def test_each_slot_holds_the_sum_of_its_entries_in_the_order_given(n_slots, count):
    """To the last digit: what is added to what stays, so that no run changes."""
    rng = np.random.default_rng(n_slots + count)
    slot, values, constant = (
        rng.integers(0, n_slots, count),
        rng.normal(size=count),
        rng.choice([-1.0, 0.3, 1.0], count),
    )
    cj = np.where(rng.random(count) < 0.1, 1.0, 0.0)
    expected = np.zeros(n_slots)
    np.add.at(expected, slot, values * (constant + 7.0 * cj))
    found = ordered_entries(slot, cj, n_slots)
    assert np.array_equal(added_up(slot, values, constant, cj, found, 7.0, n_slots), expected)


def test_a_slot_begins_with_its_first_entry_and_those_with_cj_come_last():
    found = ordered_entries(np.array([2, 0, 2, 1, 0]), np.array([0.0, 0, 0, 1, 0]), 3)
    assert found.order.tolist() == [1, 0, 2, 4, 3]
    assert (found.n_first, found.n_constant, found.n_cleared, found.bare.tolist()) == (2, 4, 0, [1])


def test_a_matrix_of_mostly_empty_slots_is_cleared_as_a_whole():
    found = ordered_entries(np.array([7, 3]), np.zeros(2), 10)
    assert (found.n_first, found.n_constant, found.n_cleared, len(found.bare)) == (0, 2, 10, 0)
