"""Geometry of paths, over the path position."""
