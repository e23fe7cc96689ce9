"""The kinds of devices: servers, clients, parts on a conveyor, wires, and those that a world file declares."""
