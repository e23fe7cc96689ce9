"""Plans: what determines the rows of a sweep, as data; what is drawn for a run."""
