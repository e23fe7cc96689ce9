"""Corrections of a nominal motion while it runs: conveyors, path offsets, force."""
