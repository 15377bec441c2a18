"""Tests of the estimate of the errors of a run."""
