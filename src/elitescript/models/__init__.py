"""The robot models and their data.

Each arm is one TOML file in which every number names its source; `make reference` writes it down as Python in
`tables`, which is what a process reads. Adding a model is adding a file.
"""
