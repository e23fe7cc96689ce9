"""Simulated connections and lines: their delay, and what goes wrong on them."""
