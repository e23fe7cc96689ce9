"""The primary port and its variants: secondary, realtime, read-only."""
