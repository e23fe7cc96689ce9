"""Detects mistakes from other languages and older Pythons, and explains them."""
