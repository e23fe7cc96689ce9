"""The requests of the protocol, one file for each group."""
