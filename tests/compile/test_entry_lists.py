"""Entries of a matrix in the order in which compiled code adds them up."""

import numpy as np
import pytest

from stiffmbs.compile.equations import entry_lists


def added_up(lists, values, cj, n_slots):
    """As `stiffmbs.compile.machine.native.evaluate.add_entries`."""
    a = np.zeros(n_slots)
    for k, slot in enumerate(lists["m_slot"]):
        late = k >= lists["n_constant"]
        a[slot] += values[lists["m_source"][k]] * (lists["m_constant"][k] + (lists["m_cj"][k] * cj if late else 0.0))
    return a


@pytest.mark.parametrize(("n_slots", "count"), [(40, 150), (40, 30), (300, 60), (5, 0)])
def test_each_slot_holds_the_sum_of_its_entries_in_the_order_given(n_slots, count):
    """To the last digit, so that no run changes."""
    rng = np.random.default_rng(n_slots + count)
    slot, source, values = rng.integers(0, n_slots, count), rng.permutation(count), rng.normal(size=count)
    constant, cj = rng.choice([-1.0, 0.3, 1.0], count), np.where(rng.random(count) < 0.1, 1.0, 0.0)
    expected = np.zeros(n_slots)
    np.add.at(expected, slot, values[source] * (constant + 7.0 * cj))
    assert np.array_equal(added_up(entry_lists(slot, source, constant, cj), values, 7.0, n_slots), expected)


def test_all_entries_of_a_slot_with_cj_come_last():
    slot, cj = np.array([2, 1, 2, 1, 0]), np.array([0.0, 0.0, 0.0, 1.0, 0.0])
    found = entry_lists(slot, np.arange(5), np.ones(5), cj)
    assert (found["n_constant"], found["m_source"].tolist()) == (3, [0, 2, 4, 1, 3])
