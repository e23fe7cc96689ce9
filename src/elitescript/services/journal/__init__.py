"""Record and replay sessions."""
