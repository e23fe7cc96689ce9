"""What the names in a program stand for: commands, restricted built-ins, modules, files."""
