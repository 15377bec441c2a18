"""Roads and tables: kinks, cars over straight lines, and interpolation between points."""
