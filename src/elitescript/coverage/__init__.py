"""Coverage of robot programs: what was run of them, and the reports of that."""
