"""Contact, the force sensor, force control and hand guiding."""
