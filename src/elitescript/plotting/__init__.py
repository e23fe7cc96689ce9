"""Builds plot pages: a run as one self-contained HTML file.

Pure: rows of a trace and events go in, text comes out.
"""
