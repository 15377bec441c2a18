"""Symbols of joints and forces, by kind; a kind without its own has that of its family."""
