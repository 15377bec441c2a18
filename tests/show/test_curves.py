"""Charts of pages: round axes, peaks that stay, labels as text."""

from xml.etree import ElementTree

import numpy as np
import pytest

import stiffmbs
from stiffmbs.errors import InputError
from stiffmbs.model.scene import Figure
from stiffmbs.show.curves import Curve, _thinned, curve_chart, polar_chart, round_step, spark_line
from stiffmbs.show.report import figure_charts, is_charted

from ..conftest import EXAMPLES


@pytest.mark.parametrize(("span", "step"), [(12.0, 2.0), (10.0, 2.0), (0.25, 0.05), (663.8, 200.0), (2e-9, 5e-10)])
def test_axes_have_round_steps(span, step):
    assert round_step(span) == pytest.approx(step)


def test_thinned_curves_keep_their_peaks_and_ends():
    x = np.linspace(0, 1, 100_000)
    y = np.where(np.arange(len(x)) == 31_415, 7.0, np.sin(300 * x))
    found_x, found_y = _thinned(x, y)
    assert len(found_x) < 2_000 and found_y.max() == 7.0 and (found_x[0], found_x[-1]) == (0.0, 1.0)


def test_a_chart_names_its_axes_and_its_peak_and_escapes_names():
    x = np.linspace(0, 2, 50)
    text = curve_chart([Curve("<b>", x, 10 * np.sin(x))], "load of <b>, kN", "time, s", "10 kN")
    words = list(ElementTree.fromstring(text).itertext())
    assert (
        "load of <b>, kN" in words and "time, s" in words and "10 kN" in words and "12" not in words and "10" in words
    )


@pytest.mark.parametrize("values", [[0.0, 0.0], [np.nan, np.nan], [1.0, np.nan], [-1.0, -3.0], [1e9, 2e9]])
def test_any_values_can_be_drawn(values):
    y = np.array(values)
    for text in (
        curve_chart([Curve("a", np.array([0.0, 1.0]), y)], "a, N", "time, s", "peak"),
        spark_line(y, np.array([0.0, 1.0])),
    ):
        assert "nan" not in text and ElementTree.fromstring(text).tag == "svg"


def test_an_axis_without_zero_has_labels_that_differ_and_fit():
    """Energies of -757 J that change by 1 mJ: the labels have ten digits, and begin within the chart."""
    x = np.linspace(0, 1, 20)
    text = curve_chart([Curve("a", x, -757.332 + 1e-3 * x)], "energy, J", "time, s", includes_zero=False)
    labels = [
        part for part in ElementTree.fromstring(text) if part.get("text-anchor") == "end" and part.text != "time, s"
    ]
    assert len({part.text for part in labels}) == len(labels) > 3 and "0" not in {part.text for part in labels}
    assert all(float(part.get("x")) > 6.5 * len(part.text) for part in labels)
    curve = next(part for part in ElementTree.fromstring(text) if part.get("class") == "curve c0")
    heights = [float(pair.split(",")[1]) for pair in curve.get("d")[1:].split("L")]
    assert max(heights) - min(heights) > 80


def test_a_constant_is_drawn_flat():
    x = np.linspace(0, 1, 20)
    text = curve_chart([Curve("a", x, 5.0 + 1e-12 * np.sin(9 * x))], "a, N", "time, s", includes_zero=False)
    curve = next(part for part in ElementTree.fromstring(text) if part.get("class") == "curve c0")
    assert len({pair.split(",")[1] for pair in curve.get("d")[1:].split("L")}) == 1


def test_the_figure_of_a_scene_has_a_chart_for_each_unit():
    changes = [("run.points", "21"), ("units.angle", "deg")]
    solution = stiffmbs.run(stiffmbs.load_scene(EXAMPLES / "bar_pendulum.yaml", changes))
    charts = list(figure_charts(solution, Figure(title="Bar", x="bar.angle", y=("bar.x", "bar.y", "hinge.fy"))))
    assert [chart.names for chart in charts] == [("bar.x", "bar.y"), ("hinge.fy",)]
    words = [list(ElementTree.fromstring(chart.drawing).itertext()) for chart in charts]
    assert "Bar, m" in words[0] and "hinge.fy, N" in words[1] and "bar.angle, deg" in words[0]
    with pytest.raises(InputError, match=r"hinge\.fz"):
        list(figure_charts(solution, Figure(y=("hinge.fz",))))
    assert not is_charted(Figure(y=("bar.y",), equal=True))


def test_a_polar_path_has_its_peak_on_the_circle_of_the_largest_value():
    turn = np.linspace(0, np.pi, 30)
    text = polar_chart(np.column_stack([np.cos(turn), np.sin(turn)]), 1.0, "pin on crank", "axes of crank", "1 N")
    dot = next(part for part in ElementTree.fromstring(text) if part.get("class") == "dot")
    outer = max(
        (part for part in ElementTree.fromstring(text) if part.tag == "circle"), key=lambda part: float(part.get("r"))
    )
    away = np.hypot(float(dot.get("cx")) - float(outer.get("cx")), float(dot.get("cy")) - float(outer.get("cy")))
    assert away == pytest.approx(float(outer.get("r")), abs=0.2)
