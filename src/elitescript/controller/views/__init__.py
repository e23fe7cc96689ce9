"""Views of the machine for clients and users: signals, snapshots, traces."""
