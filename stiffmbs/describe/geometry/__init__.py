"""The shapes of bodies, for drawings; no equation depends on them."""
