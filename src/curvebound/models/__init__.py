"""Equations of motion: one file per system, on the standard library alone."""
