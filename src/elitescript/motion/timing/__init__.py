"""Time laws: how fast a path is run."""
