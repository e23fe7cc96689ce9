"""Rules, one in each file: what it finds and why, an example, the function. A new file here is a new rule."""
