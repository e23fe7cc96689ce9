"""Runs programs: script threads in virtual time, and everything that a script can reach."""
