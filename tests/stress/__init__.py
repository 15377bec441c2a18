"""Stress tests: extreme or ill-posed models, and the outcome of each: right, told (reported), or wrong."""

import os

from .replaced import REPLACEMENT, replace_bdf

if name := os.environ.get(REPLACEMENT):
    replace_bdf(name)
