"""The gallery: a card and a page for each example, with its motion, its figure and its scene, made when pages are built.

The directive ``gallery`` has a line ``Theme: name name ...`` for each group of examples; examples that no line names
come last.  Thumbnails are stored in ``_static/gallery``; ``python docs/sphinx_plugins/thumbnails.py`` makes them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from as_rst import nodes_of
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

import stiffmbs

EXAMPLES = Path(__file__).parents[2] / "examples"
PAGES = "gallery"
"""Folder of the generated pages, in that of the sources."""
MOTION = "motion"
"""Folder of the pages in three dimensions, in that of the output."""
PAGE = """\
# {title}

{words}

```console
$ stiffmbs run examples/{name}.yaml
```

```{{raw}} html
<iframe class="motion" src="../{motion}/{stem}.html" title="{title} in motion" loading="lazy"></iframe>
<p><a href="../{motion}/{stem}.html">The page in full size</a>: the space key plays, dragging pans or orbits.</p>
```

{figure}
```{{literalinclude}} ../{examples}/{name}.yaml
:language: yaml
:caption: examples/{name}.yaml
```
"""
FIGURE = "![Figure of {title}]({stem}.svg)\n"
CARD = """\
   .. grid-item-card:: {title}
      :link: /{pages}/{stem}
      :link-type: doc
      :img-top: {picture}
      :img-alt: {title}

      {words}
"""


def examples() -> dict[str, Path]:
    """Return the scenes of the folder of examples, but for their parts, by the stems of their files."""
    found = [*EXAMPLES.glob("*.yaml"), *EXAMPLES.glob("*/*.yaml")]
    return {path.stem: path for path in sorted(found, key=lambda path: path.stem)}


def introduction(path: Path) -> str:
    """Return the comment at the beginning of a scene, as Markdown."""
    lines = path.read_text(encoding="utf-8").split("\n")
    comment = []
    for line in lines:
        if not line.startswith("#"):
            break
        comment.append(line.lstrip("# ").rstrip())
    text = " ".join(comment)
    return re.sub(r"(?<!`)(--set \S+='[^']*'|--set \S+=[\w.]+)", r"`\1`", text)


def first_sentence(text: str) -> str:
    """Return the first sentence of a text, without marks of code."""
    return re.split(r"(?<=[.])\s", text)[0].partition(":  ")[0].replace("`", "")


def write_pages(app: Sphinx) -> None:
    """Write the page, the figure and the motion of each example that is newer than its page."""
    if app.builder.format != "html":
        return
    pages, motions = Path(app.srcdir, PAGES), Path(app.outdir, MOTION)
    for folder in (pages, motions):
        folder.mkdir(parents=True, exist_ok=True)
    for stem, path in examples().items():
        page, motion = pages / f"{stem}.md", motions / f"{stem}.html"
        if not (page.exists() and motion.exists() and page.stat().st_mtime > path.stat().st_mtime):
            _write_page(path, page, motion)
    for page in pages.glob("*.md"):
        if page.stem not in examples():
            page.unlink()


def _write_page(path: Path, page: Path, motion: Path) -> None:
    from matplotlib.figure import Figure

    from stiffmbs.show.figure import draw_runs

    scene = stiffmbs.load_scene(path)
    solution = stiffmbs.run(scene)
    stiffmbs.animate(scene, motion, solution)
    if scene.figure:
        figure = Figure(figsize=(7, 3.6), layout="constrained")
        draw_runs(figure, {"": solution}, scene.figure)
        figure.savefig(page.with_suffix(".svg"))
    named = {"title": scene.name, "stem": path.stem}
    text = PAGE.format(
        **named, words=introduction(path), name=path.relative_to(EXAMPLES).with_suffix("").as_posix(), motion=MOTION,
        examples="../examples", figure=FIGURE.format(**named) if scene.figure else "",
    )  # fmt: skip
    page.write_text(text, encoding="utf-8")


class Gallery(SphinxDirective):
    """Cards of all examples in groups, each with its moving thumbnail and its first sentence."""

    has_content = True

    def run(self) -> list[nodes.Node]:
        groups = {title: names.split() for title, _, names in (line.partition(": ") for line in self.content if line)}
        named = [name for group in groups.values() for name in group]
        known = examples()
        if wrong := sorted({name for name in named if name not in known or named.count(name) > 1}):
            raise self.error(f"found {', '.join(wrong)}, expected names of examples, each once")
        groups["Further examples"] = [name for name in known if name not in named]
        text = "\n".join(line for title, names in groups.items() if names for line in self._group(title, names))
        return nodes_of(self, text, allow_section_headings=True)

    def _group(self, title: str, names: list[str]) -> Iterator[str]:
        yield from (title, "-" * len(title), "", ".. grid:: 2 3 4 4", "   :gutter: 2", "")
        for name in names:
            path = examples()[name]
            self.env.note_dependency(str(path))
            words = first_sentence(introduction(path))
            yield CARD.format(
                title=stiffmbs.load_scene(path).name,
                pages=PAGES,
                stem=name,
                words=words,
                picture=thumbnail(self.env.srcdir, name),
            )
        hidden = (f"   /{PAGES}/{name}" for name in names)
        yield from ("", ".. toctree::", "   :hidden:", "", *hidden, "")


def thumbnail(sources: str | Path, name: str) -> str:
    """Return the picture of an example: its film, or its drawing where no film is stored."""
    if Path(sources, "_static", "gallery", f"{name}.webp").exists():
        return f"/_static/gallery/{name}.webp"
    drawing = Path(sources, PAGES, f"{name}_drawing.svg")
    if not drawing.exists():
        stiffmbs.draw(examples()[name], drawing)
    return f"/{PAGES}/{drawing.name}"


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directive, and write the pages before the sources are read."""
    app.add_directive("gallery", Gallery)
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
