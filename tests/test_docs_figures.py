"""Figures of the documentation, and the pictures of the README."""

import importlib
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

import stiffmbs

from .show.page import browser

DOCS = Path(stiffmbs.__file__).parents[1] / "docs"


PICTURES = DOCS / "_static"
pytestmark = pytest.mark.skipif(not DOCS.is_dir(), reason="the documentation is not beside the package")


@pytest.fixture
def plugin(monkeypatch):
    """A module of the folder of Sphinx's plug-ins."""
    monkeypatch.syspath_prepend(str(DOCS / "sphinx_plugins"))
    return importlib.import_module


def test_plots_of_one_page_do_not_take_each_others_place():
    """MyST counts the plots of each block from one, so that they must be named."""
    for page in DOCS.glob("**/*.md"):
        text = page.read_text(encoding="utf-8")
        plots = text.count(".. plot::")
        assert plots < 2 or text.count(":filename-prefix:") == plots, page


def test_the_figure_of_run_times_is_that_of_the_measured_rows(plugin):
    made = plugin("peers_figure")
    rows = made.read_json((DOCS / "peers.jsonl").read_text(encoding="utf-8"))["andrews"]
    assert made.figure(rows) == (PICTURES / "andrews.svg").read_text(encoding="utf-8")


def test_the_moving_picture_shows_the_peak_of_its_scene_and_is_small():
    picture = PICTURES / "half_car.svg"
    assert picture.stat().st_size < 1_000_000
    words = " ".join(ElementTree.parse(picture).getroot().itertext())
    peak, bar = map(float, re.search(r"peak ([\d.]+) ± ([\d.]+) kN", words).groups())
    solution = stiffmbs.run(DOCS.parent / "examples" / "half_car.yaml", duration=0.3, errors=False)
    assert solution["front_bushing.fy"].max() / 1e3 == pytest.approx(peak, abs=bar)


@pytest.mark.parametrize(
    ("places", "expected"),
    [([5.0, 1.0], [5.0, 1.0]), ([1.0, 1.0, 9.0], [0.0, 2.0, 9.0]), ([1.0, 2.0, 4.0], [1.0 / 3, 7.0 / 3, 13.0 / 3])],
)
def test_labels_are_moved_apart_by_as_little_as_needed(plugin, places, expected):
    assert plugin("themed_svg").spread(places, 2.0) == pytest.approx(expected)


@pytest.mark.skipif(browser.found() is None, reason="no Chromium is installed")
def test_labels_of_the_pictures_do_not_cover_each_other(tmp_path):
    pytest.importorskip("websocket")
    with browser.tab(tmp_path / "browser") as tab:
        (tmp_path / "page.html").write_text(
            "".join((PICTURES / name).read_text(encoding="utf-8") for name in ("half_car.svg", "andrews.svg")),
            encoding="utf-8",
        )
        tab.do("Page.navigate", url=f"file://{tmp_path / 'page.html'}")
        tab.wait("document.querySelectorAll('svg text').length > 20")
        assert tab.run(browser.OVERLAPS) == []
