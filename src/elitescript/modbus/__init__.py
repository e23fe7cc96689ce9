"""MODBUS without I/O: requests and answers as bytes, the tables of a slave, the schedule of a master."""
