"""The safety system: states, limits, and their effect on arm, task and power."""
