"""One file for each rule: what it finds and why, an example, the function. A new file here is a new rule."""
