"""What programs reach outside themselves: real folders, and folders in memory."""
