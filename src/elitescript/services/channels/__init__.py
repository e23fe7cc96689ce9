"""The outgoing connections and serial lines of served programs."""
