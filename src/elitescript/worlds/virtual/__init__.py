"""The virtual surroundings of a robot: devices, wires and faults that live in the robot's own time."""
