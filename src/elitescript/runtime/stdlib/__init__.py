"""Modules that scripts import in place of the real ones."""
