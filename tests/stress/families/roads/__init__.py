"""Roads and tables: kinks, vehicles on piecewise linear roads, and interpolation."""
