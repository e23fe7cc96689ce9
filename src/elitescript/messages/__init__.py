"""The waist: what scripts ask, what the machine answers, and the words both use. No behaviour."""
