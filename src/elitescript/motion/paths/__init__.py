"""Geometry: where the arm goes, over the length of a path."""
