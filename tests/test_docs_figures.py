"""Figures of the documentation: MyST counts the plots of each block anew, so that they must be named."""

from pathlib import Path

import pytest

import stiffmbs

DOCS = Path(stiffmbs.__file__).parents[1] / "docs"


@pytest.mark.skipif(not DOCS.is_dir(), reason="the documentation is not beside the package")
def test_plots_of_one_page_do_not_take_each_others_place():
    for page in DOCS.glob("**/*.md"):
        text = page.read_text(encoding="utf-8")
        plots = text.count(".. plot::")
        assert plots < 2 or text.count(":filename-prefix:") == plots, page
