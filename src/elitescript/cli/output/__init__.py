"""Output of commands: text, JSON lines, tables, status line."""
