"""The live engine: programs run beside their editor, in processes that can be killed at any time."""
