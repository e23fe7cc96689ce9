"""Observers of runs, one file each; `findings.observing` says how one is written."""
