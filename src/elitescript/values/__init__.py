"""Evaluates a program without running it: what each expression can be. Pure: a tree in, descriptions out."""
