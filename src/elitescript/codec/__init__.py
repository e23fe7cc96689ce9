"""Messages of the waist as JSON text, and back; the sender need not be trusted."""
