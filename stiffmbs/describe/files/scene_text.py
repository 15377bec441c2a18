"""Scenes as the text of scene files."""

from __future__ import annotations

from io import StringIO
from typing import Any

WIDTH = 140


def scene_text(found: dict[str, Any]) -> str:
    """The text of a scene file that holds a mapping; innermost lists and mappings stand in one line."""
    from ruamel.yaml import YAML

    yaml, out = YAML(), StringIO()
    yaml.default_flow_style, yaml.width = None, WIDTH
    yaml.dump(found, out)
    return out.getvalue()
