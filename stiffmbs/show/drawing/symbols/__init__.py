"""The symbols of joints and forces, by kind: a kind without one of its own has its family's."""
