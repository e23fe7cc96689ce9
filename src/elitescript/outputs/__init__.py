"""Files that are written: every output of a call, checked before anything runs, and whole or not there."""
