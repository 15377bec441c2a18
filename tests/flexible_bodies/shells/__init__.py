"""Tests of shells in meshes."""
