"""Time laws of paths."""
