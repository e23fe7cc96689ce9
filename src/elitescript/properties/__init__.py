"""Properties and measures of a run: expressions over its record and over time, with margins.

Texts are parsed by a small grammar on `ast` and never evaluated as Python.
"""
