"""Says why a thread does not go on: the condition of its loop with the values in it, or what it waits for.

Nothing of the program runs for that: names are looked up where they are stored, commands that only read give what the
next look of the program would give, since time stands. What could only be known by asking a device again is left out.
"""
