"""A program that lets a computer control the arm, as the programs of drivers do, but small.

It opens three connections and obeys what comes in on them; see `pc` for the numbers. It uses the commands in the
ways in which such programs call them.
"""

from __future__ import annotations

from typing import Final

BODY: Final = '''
import threading
import time
import queue
import os
import signal

global mode
global target
global is_fresh
global velocity
global left

MICRO = 1000000
READ_S = 0.5
STOP_ACCELERATION = 8.0
GUARD = threading.Lock()

class Line(queue.Queue):
    def __init__(self):
        super().__init__()
        self.changed = threading.Condition(self.mutex)

    def put(self, item):
        super().put(item)
        with self.mutex:
            self.changed.notify_all()

    def wait_for(self, count, timeout):
        begin = time.time()
        with self.mutex:
            while self._qsize() < count:
                rest = timeout - (time.time() - begin)
                if rest <= 0:
                    break
                self.changed.wait(rest)
            return self._qsize()

    def last(self):
        with self.mutex:
            return self.queue[-1] if self._qsize() else None

"""
A text that stands alone, as some programs have it.
"""
def six(numbers, begin):
    return [numbers[begin + n] / MICRO for n in range(6)]

def is_slow_enough(start, end, time):
    for n in range(6):
        if norm(end[n] - start[n]) / time > 30.0:
            text = "joint {} is to move too fast: {} to {}".format(n, start[n], end[n])
            popup(text, title="Control", blocking=False, warning=True)
            return False
    return True

def never_called():
    try:
        subprocess.run(["ps"])
    except Exception as e:
        textmsg("failed: " + str(e))

def serve(own):
    global is_fresh
    while mode == own:
        joints = None
        with GUARD:
            if is_fresh:
                joints = target
            elif is_fresh is not None:
                speeds = get_target_joint_speeds()
                for n in range(len(speeds)):
                    target[n] += speeds[n] * get_steptime()
                joints = target
            if is_fresh:
                is_fresh = False
        if joints is None:
            sync()
        else:
            servoj(joints, t = 0.008, lookahead_time = 0.1, gain=300)
    stopj(STOP_ACCELERATION)

def serve_queued(own, points):
    points.wait_for(5, 0.5)
    while mode == own:
        servoj(points.get(), t = 0.008, lookahead_time = 0.1, gain=300)

def drive(own):
    while mode == own:
        if own == 2:
            speedj(velocity, 40.0, get_steptime())
        else:
            speedl(velocity, 40.0, get_steptime())
    stopj(STOP_ACCELERATION)

def follow():
    global left
    radius = int()
    while left > 0:
        point = socket_read_binary_integer(21, "points", READ_S)
        left -= 1
        radius = 0 if left <= 0 else point[20] / MICRO
        if point[0] > 0:
            duration = point[19] / 1000
            if point[21] == 0:
                movej(six(point, 1), t = duration, r = radius)
            else:
                movel(six(point, 1), t = duration, r = radius)
    socket_send_int(0, "points")

def drain():
    global left
    while left > 0:
        socket_read_binary_integer(21, "points")
        left = left - 1

def equipment():
    while mode > -2:
        numbers = socket_read_binary_integer(26, "equipment", 0)
        if numbers[0] > 0:
            what = numbers[1]
            if what == 0:
                zero_ftsensor()
            elif what == 1:
                set_payload(numbers[2] / MICRO, [numbers[3] / MICRO, numbers[4] / MICRO, numbers[5] / MICRO])
            elif what == 2:
                set_tool_voltage(int(numbers[2] / MICRO))
            elif what == 3:
                force_mode(six(numbers, 2), six(numbers, 8), six(numbers, 14), numbers[20], six(numbers, 21))
            elif what == 4:
                end_force_mode()

def end_of(thread):
    stop_thread(thread)
    join_thread(thread)
    return 0

socket_open("10.0.0.1", 50001, "commands")
socket_open("10.0.0.1", 50003, "points")
socket_open("10.0.0.1", 50004, "equipment")
mode = -1
left = 0
velocity = [0, 0, 0, 0, 0, 0]
target = get_actual_joint_positions()
is_fresh = None
points = Line()
helper = start_thread(equipment, ())
mover = 0
limit_s = 0.0

while mode > -2:
    command = socket_read_binary_integer(8, "commands", limit_s)
    if command[0] != 8:
        textmsg("no command in time: ", command[0])
        break
    limit_s = command[1] / 1000.0
    if command[8] != mode:
        if mode == 6:
            end_freedrive_mode()
        was_following = mode == 3 and left > 0
        mode = command[8]
        mover = end_of(mover)
        stopj(STOP_ACCELERATION)
        if was_following:
            drain()
            socket_send_int(1, "points")
        target = get_actual_joint_positions()
        is_fresh = None
        if mode == 1 or mode == 5:
            mover = start_thread(serve, (mode,))
        elif mode == 2 or mode == 4:
            velocity = six(command, 2)
            mover = start_thread(drive, (mode,))
        elif mode == 8:
            points = Line()
            points.put(target)
            mover = start_thread(serve_queued, (mode, points))
    if mode == 1 or mode == 5:
        with GUARD:
            goal = six(command, 2)
            if mode == 5:
                goal = get_inverse_kin(goal, target)
            if is_slow_enough(target, goal, 0.008):
                target = goal
                is_fresh = True
    elif mode == 8:
        points.put(six(command, 2))
    elif mode == 2 or mode == 4:
        velocity = six(command, 2)
    elif mode == 3 and command[2] == 1:
        mover = end_of(mover)
        drain()
        left = command[3]
        mover = start_thread(follow, ())
    elif mode == 3 and command[2] == -1:
        mover = end_of(mover)
        drain()
        stopj(STOP_ACCELERATION)
        socket_send_int(1, "points")
    elif mode == 6 and command[2] == 1:
        freedrive_mode()
    elif mode == 6 and command[2] == -1:
        end_freedrive_mode()

helper = end_of(helper)
mover = end_of(mover)
stopj(STOP_ACCELERATION)
textmsg("control has ended")
socket_close("commands")
socket_close("points")
socket_close("equipment")
'''

PROGRAM: Final = "def control():\n" + "".join(f"\t{line}\n" for line in BODY.split("\n")) + "end\n"
"""As it is uploaded: every line behind a tab, the empty ones too."""
