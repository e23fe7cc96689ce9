"""What programs reach outside themselves on this computer: task folder, channels, serial ports, the state file."""
