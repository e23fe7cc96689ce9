"""Script threads in virtual time: how one is suspended, the order in which they run, when waits end."""
