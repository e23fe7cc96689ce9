"""What is found in a run: observers, and the one list of findings of text and run."""
