"""The Debug Adapter Protocol."""
