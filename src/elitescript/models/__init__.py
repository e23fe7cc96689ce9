"""The robot models and their data.

Each arm is one TOML file in which every number names its source. Adding a model is adding a
file.
"""
