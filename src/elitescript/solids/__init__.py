"""Solids of arms, tools and things: their shapes, closest distances and contacts."""
