"""A robot beside the simulated one: what differs, where first, and which parameters explain it."""
