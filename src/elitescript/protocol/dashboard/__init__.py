"""The dashboard shell, port 29999."""
