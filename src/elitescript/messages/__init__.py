"""The waist: requests of scripts and clients, events, replies and state of the machine. Frozen data, no behaviour."""
