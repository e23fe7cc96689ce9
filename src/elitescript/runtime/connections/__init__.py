"""What programs speak through: sockets, serial lines, remote procedures, MODBUS signals."""
