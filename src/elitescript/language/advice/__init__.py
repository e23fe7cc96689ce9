"""Mistakes that texts of other languages and older Pythons bring, in plain words."""
