"""Ticks against the wall clock, or in step with clients."""
