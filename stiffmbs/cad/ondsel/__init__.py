"""Text files .asmt of OndselSolver, the multibody solver of FreeCAD."""
