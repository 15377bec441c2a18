"""The command ``stiffmbs open``."""

from __future__ import annotations

import click

from ..scene import refusing


@click.command("open", short_help="Edit and solve in the browser.")
@click.argument("scene")
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Port on the loopback interface; any free one by default."
)
@click.option("--browser/--no-browser", default=True, show_default=True, help="Whether to open the browser.")
def open_scene(scene: str, port: int, browser: bool) -> None:
    """Open SCENE on a page in the browser that solves it again after every change.

    The page has the text of the scene, the mechanism in motion, plots, the verdict, and sliders for the parameters. A new
    name begins an empty scene. The server listens on the loopback interface alone, and its address contains a token.
    Ctrl-C ends it. Needs the extra live.

    Exit status: 0 done, 2 the input is wrong.
    """
    from ...live.page import open as open_page

    with refusing(scene):
        page = open_page(scene, port, browser)
    click.echo(f"open: {page.url}")
    click.echo("Ctrl-C ends the page's server.")
    page.wait()
