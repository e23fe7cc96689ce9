"""Results: the journal of rows, tables, summaries and pages."""
