"""A process that compiles many models in turn keeps a bounded number of their equations and sources in memory."""

import gc
import weakref

import pytest

from stiffmbs.compile import record
from stiffmbs.compile.directional import direction
from stiffmbs.compile.machine import compiler
from stiffmbs.compile.machine.translate import unit
from stiffmbs.presolve import relations

KEPT = [
    record._record_of, record._terms, record.source_of, compiler.compiled_source, direction.directional_kernel,
    relations._summands,
]  # fmt: skip
"""Functions that keep results for each kind of element, or for each generated source."""


@pytest.mark.parametrize("function", KEPT, ids=lambda function: function.__name__)
def test_results_by_kinds_and_sources_are_bounded(function):
    assert function.cache_info().maxsize


def test_the_tree_of_a_generated_source_is_not_kept():
    def entry(k):
        names = {}
        text = f"def kernel(x):\n    x[0] = {k}.5\n"
        exec(compile(text, "<kernel>", "exec"), names)
        return unit.Entry(names["kernel"], "kernel", ["float64*"], "void"), text

    before = unit._functions.cache_info().currsize
    for k in range(3):
        one, text = entry(k)
        assert '@"kernel"' in unit.assembly([one], text)
    assert unit._functions.cache_info().currsize == before


def test_code_that_is_no_longer_kept_is_found_again_at_its_address():
    source = "def kernel(x):\n    x[0] = 0.625\n"
    first = compiler.compiled_source(source, "kernel", "void(float64*)")
    address, alive = first.address, weakref.ref(first.call)
    compiler.compiled_source.cache_clear()
    del first
    gc.collect()
    assert alive() is None
    assert compiler.compiled_source(source, "kernel", "void(float64*)").address == address
