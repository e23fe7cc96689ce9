"""What commands print: text, JSON lines, tables, status line."""
