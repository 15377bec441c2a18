"""The page of examples: each scene with what its first lines say about it, its drawing and its figure, made when pages are built."""

from __future__ import annotations

from pathlib import Path
from textwrap import indent
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from stiffmbs import load_scene

PLOT = """\
.. plot::
   :include-source: false
   :alt: {name}

   import stiffmbs
   from matplotlib import pyplot
   from stiffmbs.show.figure import draw_on

   scene = stiffmbs.load_scene("examples/{name}.yaml")
   draw_on(pyplot.figure(), stiffmbs.run(scene), scene.figure)
"""

DRAWING = """\
.. plot::
   :include-source: false
   :alt: drawing of {name}

   import stiffmbs

   stiffmbs.draw("examples/{name}.yaml", checked=True)
"""


class Scenes(SphinxDirective):
    """All scenes of a folder and of its folders by theme, a section each."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        folder = Path(self.env.srcdir, self.arguments[0])
        scenes = sorted([*folder.glob("*.yaml"), *folder.glob("*/*.yaml")], key=lambda path: path.stem)
        text = "\n".join(self._section(path, path.relative_to(folder).with_suffix("").as_posix()) for path in scenes)
        return self.parse_text_to_nodes(text, allow_section_headings=True)

    def _section(self, path: Path, name: str) -> str:
        self.env.note_dependency(str(path))
        scene = load_scene(path)
        figure = PLOT.format(name=name) if scene.figure else ""
        drawing = DRAWING.format(name=name)
        title = f"{scene.name}\n{'-' * len(scene.name)}\n"
        source = ".. code-block:: yaml\n\n" + indent(path.read_text(encoding="utf-8"), "   ")
        return f"{title}\n``examples/{name}.yaml``\n\n{drawing}\n{figure}\n{source}\n"


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("scenes", Scenes)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
