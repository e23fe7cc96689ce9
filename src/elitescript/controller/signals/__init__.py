"""The signal image: levels, faults of inputs, access by name and by Modbus address."""
