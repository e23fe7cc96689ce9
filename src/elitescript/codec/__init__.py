"""Writes messages of the waist as JSON text and reads them back, whoever has written them."""
