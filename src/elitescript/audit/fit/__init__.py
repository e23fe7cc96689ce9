"""Parameters of a real arm from what is known of it: points with joints and pose, or a recording."""
