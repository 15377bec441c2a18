"""Text of scene files."""

from __future__ import annotations

from io import StringIO
from typing import Any

WIDTH = 140


def scene_text(found: dict[str, Any]) -> str:
    """Return a mapping as the text of a scene file; innermost lists and mappings are in flow style."""
    from ruamel.yaml import YAML

    yaml, out = YAML(), StringIO()
    yaml.default_flow_style, yaml.width = None, WIDTH
    yaml.dump(found, out)
    return out.getvalue()
