"""The primary port and its relatives."""
