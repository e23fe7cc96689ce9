"""A debugged run: stops at counted statements, goes back and forth, and is looked into; no protocol."""
