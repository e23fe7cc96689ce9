"""Clients of the ports: accepted, read within a budget, and written to."""
