"""The client side of the controller's ports: states, messages and programs over the network."""
