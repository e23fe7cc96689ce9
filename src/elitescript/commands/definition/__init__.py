"""Defines what a command is: registration, arguments, units, texts, and the interfaces that its body may use."""
