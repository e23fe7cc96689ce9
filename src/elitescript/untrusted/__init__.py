"""Data that others wrote: read within bounds, before anything is parsed."""
