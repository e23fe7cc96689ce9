"""What is simulated beside the robot, in its own time: devices, wires, faults, and the file that declares them."""
