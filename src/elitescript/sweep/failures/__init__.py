"""Failing runs: made smaller, told, written as cases."""
