"""Shells of a mesh: elements, checks and geometric stiffness."""
