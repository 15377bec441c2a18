"""Random scenes: well-posed mechanisms of all kinds of elements, as the content of scene files."""
