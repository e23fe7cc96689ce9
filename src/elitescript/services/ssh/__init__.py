"""The SSH port: commands, files in memory, log, bridges to serial lines."""
