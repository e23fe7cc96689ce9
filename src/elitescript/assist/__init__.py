"""Editor services: pure functions over a `Document`; no protocol, no I/O."""
