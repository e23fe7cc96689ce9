"""The gripper of electric_gripper.script, as its world file names it."""

from elitescript.testing.world import ModbusDevice

COMMAND, WIDTH = 0, 1
INITIALISE, MOVE = 1, 2
STATE = 0
INITIALISING, MOVING, THERE, HOLDING, LOST = 1, 2, 3, 4, 5
MM_S = 80.0
OPEN = 600


class Gripper(ModbusDevice):
    """Two fingers and a motor; widths in the registers are in 0.1 mm.

    Attributes:
        things: width of what comes between the fingers each time that they close, mm; 0 for nothing.
        slips: seconds after which that of the same number slips out; 0 if it does not.
    """

    line = "tool"
    unit = 65
    baud = 115200
    holding_registers = 3  # command, width, force in N
    input_registers = 3  # state, width, number of a fault
    things = ()
    slips = ()

    def started(self):
        self.closings = 0
        self.moves = 0
        self.goal = OPEN

    def register_written(self, address, value):
        if address != COMMAND:
            return  # the others say how
        if value == INITIALISE:
            self.moves += 1
            self.input_registers[STATE] = INITIALISING
            self.after(1.5, self.arrive, self.moves, THERE, OPEN)
        elif value == MOVE and self.input_registers[STATE] == 0:
            self.refuse(4)  # not initialised
        elif value == MOVE and self.goal != self.holding_registers[WIDTH]:
            self.move(self.holding_registers[WIDTH])
        elif value != MOVE:
            self.refuse(3)

    def move(self, wanted):
        self.goal = wanted
        self.moves += 1
        width = self.input_registers[WIDTH]
        thing = slips_s = 0
        if wanted < width and self.closings < len(self.things):
            thing = round(self.things[self.closings] * 10)
            slips_s = self.slips[self.closings] if self.closings < len(self.slips) else 0
        self.closings += wanted < width
        end = max(wanted, thing)
        self.input_registers[STATE] = MOVING
        self.after(abs(width - end) / 10 / MM_S, self.arrive, self.moves, HOLDING if thing > wanted else THERE, end)
        if slips_s:
            self.after(slips_s, self.arrive, self.moves, LOST, wanted)

    def arrive(self, move, state, width):
        if move == self.moves:  # nothing else has been asked for since
            self.input_registers[STATE] = state
            self.input_registers[WIDTH] = width
