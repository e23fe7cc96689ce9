"""Engines: what runs the runs of a plan, in child processes here or on a cluster."""
