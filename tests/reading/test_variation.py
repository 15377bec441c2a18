"""The syntax of values that studies, comparisons and fits share."""

import numpy as np
import pytest

from stiffmbs import Range
from stiffmbs.errors import InputError
from stiffmbs.reading.variation import numbers_of, read_variation, variation
from stiffmbs.studies.case_solver import written_scene
from stiffmbs.studies.parameters import parameter_ranges

STIFFNESS = (1, 0, -2)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("0:1:3", (0.0, 0.5, 1.0)),
        ("5:1:5", (1.0, 2.0, 3.0, 4.0, 5.0)),
        ("1e5:1e9:3:log", (1e5, 1e7, 1e9)),
        ("1e-2 : 1e-4 : 3 : log", (1e-4, 1e-3, 1e-2)),
        ("pi/2:pi:2", (np.pi / 2, np.pi)),
        ("3, 1,2e0", (3.0, 1.0, 2.0)),
        ("7", (7,)),
        ("bdf,projected", ("bdf", "projected")),
        ("2a,2b", ("2a", "2b")),
        ("[0, 1e-3],[1, 0]", ([0, 1e-3], [1, 0])),
        ("../a.csv,../b.csv", ("../a.csv", "../b.csv")),
        ("1e5..1e9:3", (1e5, 1e7, 1e9)),
        ("1.5..2.5:2", (1.5, 2.5)),
        ("-1..100:2", (-1.0, 100.0)),
    ],
)
def test_values_of_a_grid(text, values):
    found = variation("k", text)
    assert found.values == pytest.approx(values) if isinstance(values[0], float) else found.values == values
    assert found == read_variation(f"k={text}", "--vary")
    assert found.dimension is None


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("100:1e3 N/mm:2", (1e5, 1e6)),
        ("1 kN/m : 1e3 kN/m:4:log", (1e3, 1e4, 1e5, 1e6)),
        ("1e2..1e4 N/mm:3", (1e5, 1e6, 1e7)),
        ("20, 100 N/mm,1 kN/m", (2e4, 1e5, 1e3)),
        ("5 N/m", (5.0,)),
    ],
)
def test_values_with_units_are_in_si_and_keep_their_dimension(text, values):
    assert variation("k", text).values == pytest.approx(values)
    assert variation("k", text).dimension == STIFFNESS


def test_values_of_a_whole_decade_are_round_numbers():
    assert variation("k", "1e5:1e9:5:log").values == (1e5, 1e6, 1e7, 1e8, 1e9)
    assert variation("k", Range(10, 1000, log=True, count=3)).values == (10.0, 100.0, 1000.0)


@pytest.mark.parametrize(
    "text",
    ["1:", "1:1", "1:2:1", "1:2:x", "a:b", "0:1:3:log", "1 kN:2 furlongs", "1 kN:2 m", "1 kN:x", "1,,2", "1 kN,2 m", "1:2:3:4"],
)  # fmt: skip
def test_what_is_no_range_is_refused(text):
    with pytest.raises(InputError, match=r"--vary k="):
        read_variation(f"k={text}", "--vary")


def test_a_comparison_chooses_the_number_of_values_if_there_is_none():
    assert numbers_of(variation("rtol", "1e-3:1e-5:log"), 2) == pytest.approx((1e-5, 10**-4.5, 1e-4, 10**-3.5, 1e-3))
    assert numbers_of(variation("k", "1:5"), 2) == (1.0, 2.0, 3.0, 4.0, 5.0)


def test_bounds_of_a_search_are_a_range_its_text_or_a_pair(examples):
    scene = written_scene(examples / "half_car.yaml")
    given = {"k_b": "1e5:1e6:log", "zeta": (0.01, 0.3), "V": Range(10, 20)}
    assert parameter_ranges(given, scene).ranges == (Range(1e5, 1e6, log=True), Range(0.01, 0.3), Range(10, 20))
    for wrong in ("1,2", "1:2:3", "1 mm:2 mm"):
        with pytest.raises(InputError, match="k_b"):
            parameter_ranges({"k_b": wrong}, scene)
