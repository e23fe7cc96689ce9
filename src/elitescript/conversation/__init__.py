"""What a page and its source say to each other: messages checked, rows as bytes, runs described."""
