"""The gripper of gripper.script."""

from elitescript.testing.world import TcpServer


class Gripper(TcpServer):
    """Takes `SET NAME number`, answers `GET NAME` with `NAME number`."""

    position = 0

    def line_received(self, connection, line):
        verb, name, *value = line.split(" ")
        if verb == "GET":
            return f"{name} {self.position}"
        if name == "POS":
            self.position = int(value[0])
        return None
