"""How Sphinx builds these pages: ``sphinx-build -W -n docs build/html``."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "sphinx_plugins"), str(HERE.parent)]  # the second for tests.bench, whose results pages show

import stiffmbs  # noqa: E402

project = "stiffmbs"
version = release = stiffmbs.__version__
copyright = "the authors of stiffmbs"

extensions = [
    "sphinx.ext.autodoc",
    "numpydoc",
    "myst_nb",
    "sphinx_click",
    "sphinx_copybutton",
    "sphinx_design",
    "matplotlib.sphinxext.plot_directive",
    "kinds",
    "gallery",
    "mathml",
    "measured",
    "note_kinds",
    "shipped_parts",
]
exclude_patterns = ["sphinx_plugins"]
suppress_warnings = ["toc.empty_glob"]  # a page that a pattern stands for may be missing
default_role = "literal"

html_theme = "furo"
html_title = f"stiffmbs {version}"
html_show_sphinx = False
html_math_renderer = "mathml"
html_static_path = ["_static"]
html_css_files = ["style.css"]

nb_execution_mode = "force"  # notebooks are stored without outputs
nb_execution_raise_on_error = True
nb_execution_timeout = 300

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_typehints = "none"  # docstrings name types with their shapes and units
numpydoc_show_class_members = False

plot_working_directory = str(HERE.parent)  # scenes are read from examples/
plot_html_show_formats = False
plot_html_show_source_link = False
plot_include_source = True
plot_formats = [("png", 110)]
plot_rcparams = {
    "figure.figsize": (7, 3.6),
    "figure.constrained_layout.use": True,
    "axes.grid": True,
    "grid.alpha": 0.3,
}
plot_apply_rcparams = True

copybutton_prompt_text = "$ "
