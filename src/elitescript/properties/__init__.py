"""Properties and measures of a run: expressions over its record and over time, with margins.

Texts are parsed by a small grammar on `ast` and never evaluated as Python. `parsing` reads them, once; `checks` gives
each run its watches, which are shown the run while it goes on, so that no rows are kept.
"""
