"""The client side of the controller's ports: states, messages and programs over the network.

The `..._messages` modules turn bytes into records and back, without I/O, from the tables that the server side has. The
clients over them are asyncio connections, which only read unless they were made with `may_command`. They work with any
controller: what an older one does not have is left out.
"""
