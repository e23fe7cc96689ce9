"""The MODBUS TCP master: signals, connections, requests under way."""
