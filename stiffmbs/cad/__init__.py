"""Assemblies of CAD programs: Simscape Multibody XML and the .asmt files of FreeCAD's solver."""
