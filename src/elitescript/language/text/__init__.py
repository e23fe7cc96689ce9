"""Splits the text of a program into lines, tokens and blocks, and rewrites it as Python."""
