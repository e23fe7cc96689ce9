"""The RTSI port, 30004."""
