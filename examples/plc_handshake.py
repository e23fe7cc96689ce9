"""The PLC of plc_handshake.script, as its world file names it."""

from elitescript.testing.world import ModbusDevice

REQUEST, TAKEN = 0, 1  # discrete inputs
NUMBER, COUNT = 0, 1  # input registers
BUSY, DONE = 0, 1  # coils
ROBOT_COUNT, RESULT = 0, 1  # holding registers
SCAN_S = 0.02


class Plc(ModbusDevice):
    """Asks for one part after the other, as its program does in each scan.

    Attributes:
        numbers: of the parts that it wants.
        pause_s: from one part to the request for the next.
    """

    port = 502
    latency_s = 0.004
    coils = 2
    discrete_inputs = 2
    holding_registers = 2
    input_registers = 2
    numbers = ()
    pause_s = 0.5

    def started(self):
        self.wanted = list(self.numbers)
        self.step = self.idle
        self.scans_left = 50
        self.every(0.1, self.count)
        self.every(SCAN_S, self.scan)

    def count(self):
        self.input_registers[COUNT] = (self.input_registers[COUNT] + 1) % 65536

    def scan(self):
        self.step()

    def idle(self):
        self.scans_left -= 1
        if self.scans_left <= 0 and self.wanted and not self.coils[BUSY]:
            self.input_registers[NUMBER] = self.wanted[0]
            self.discrete_inputs[REQUEST] = True
            self.step = self.requested

    def requested(self):
        if self.coils[BUSY]:
            self.input_registers[NUMBER] = 0
            self.discrete_inputs[REQUEST] = False
            self.step = self.in_work

    def in_work(self):
        if self.coils[DONE] and self.holding_registers[RESULT]:
            number = self.wanted.pop(0)
            self.log(f"part of kind {number}: result {self.holding_registers[RESULT]}")
            self.discrete_inputs[TAKEN] = True
            self.step = self.taken

    def taken(self):
        if not (self.coils[DONE] or self.coils[BUSY] or self.holding_registers[RESULT]):
            self.discrete_inputs[TAKEN] = False
            self.scans_left = self.pause_s / SCAN_S
            self.step = self.idle
