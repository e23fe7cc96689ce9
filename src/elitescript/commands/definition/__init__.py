"""What a command is: its registration, arguments, units, texts, and what its body may use."""
