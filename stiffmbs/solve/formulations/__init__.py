"""Formulations of the residual that the BDF integrator solves, one per file, named as in Adams."""

from .si2 import SI2

FORMULATIONS = {formulation.name: formulation for formulation in (SI2,)}
