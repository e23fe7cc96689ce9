"""What others see of the machine: its state, the snapshot for ports, traces."""
