"""The studio: one page on this computer over live runs, recordings and controllers."""
