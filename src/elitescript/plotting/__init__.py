"""Pages to look at: what a run did, as one HTML file that needs nothing else.

Pure: rows of a trace and events go in, text comes out.
"""
