"""A robot in a child process: started, supervised, locked in; and the messages between."""
