"""The model files of the package as Python data, written by `make reference`: TOML is for people to edit."""
