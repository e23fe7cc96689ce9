"""MODBUS without I/O: requests and answers as bytes, tables of a slave, schedule of a master."""
