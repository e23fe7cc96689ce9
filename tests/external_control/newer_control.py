"""A program as newer drivers upload it: longer messages, user frames, and a report for each point.

Commands have nine numbers (a user frame before the mode), points 22 (speed, acceleration and a user frame besides), and
what comes back for each event of a trajectory has ten, each sent by itself. It calls what such programs call besides.
"""

from __future__ import annotations

from typing import Final

BODY: Final = """
import threading
import time
import queue
import os
import signal

global mode
global left
global total
global frames

MICRO = 1000000
BASE = -1
EXTRAPOLATE_S = 0.08
DECELERATE_S = 0.01
HOLD_SPEED = 0.05
HOLD_S = 0.04
frames = [[0, 0, 0, 0, 0, 0], [0.1, 0, 0, 0, 0, 1.5707963]]

def six(numbers, begin):
    return [numbers[begin + n] / MICRO for n in range(6)]

def in_base(pose, number):
    if number == BASE:
        return pose
    return pose_trans(frames[number], pose)

def report(kind, index, result, values):
    for number in [kind, index, total, result]:
        socket_send_int(number, "points")
    for n in range(6):
        socket_send_int(int(round(values[n] * MICRO)), "points")

def follow():
    global left
    index = 0
    while left > 0:
        point = socket_read_binary_integer(22, "points", 0.5)
        left -= 1
        if point[0] != 22:
            continue
        goal = six(point, 1)
        report(1, index, -1, goal)
        duration = point[19] / 1000
        radius = 0 if left <= 0 else point[20] / MICRO
        speed = point[7] / MICRO
        acceleration = point[8] / MICRO
        if point[21] == 1:
            goal = in_base(goal, point[22])
        if point[21] == 1 and duration > 0:
            movel(goal, t=duration, r=radius)
        elif point[21] == 1:
            movel(goal, a=acceleration, v=speed, r=radius)
        elif duration > 0:
            movej(goal, t=duration, r=radius)
        else:
            movej(goal, a=acceleration, v=speed, r=radius)
        report(2, index, -1, goal)
        index += 1
    report(3, index, 0, get_actual_joint_positions())

def equipment():
    global frames
    while mode > -2:
        numbers = socket_read_binary_integer(26, "equipment", 0)
        if numbers[0] > 0:
            what = numbers[1]
            if what == 9:
                set_collision_detect_enabled(numbers[2] == 1)
            elif what == 10:
                set_dyn_collision_force_min_ratio(numbers[2])
            elif what == 11:
                turn = numbers[2] / MICRO
                tilt = numbers[3] / MICRO
                g = 9.82
                set_gravity([g * sin(tilt) * cos(turn), g * sin(tilt) * sin(turn), g * cos(tilt)])
            elif what == 12:
                frames[numbers[2]] = six(numbers, 3)
            elif what == 5:
                near = six(numbers, 8)
                tcp = six(numbers, 14)
                if get_inverse_kin_has_solution(six(numbers, 2), near, tcp):
                    for value in get_inverse_kin(six(numbers, 2), near, tcp):
                        socket_send_int(int(round(value * MICRO)), "equipment")
            elif what == 6:
                for value in get_forward_kin(six(numbers, 2), six(numbers, 8)):
                    socket_send_int(int(round(value * MICRO)), "equipment")
            elif what == 7:
                socket_send_byte_list([1, 2, 255], "equipment")

socket_open("10.0.0.1", 50001, "commands")
socket_open("10.0.0.1", 50003, "points")
socket_open("10.0.0.1", 50004, "equipment")
mode = -1
left = 0
total = 0
helper = start_thread(equipment, ())
mover = 0
limit_s = 0.0

while mode > -2:
    command = socket_read_binary_integer(9, "commands", limit_s)
    if command[0] != 9:
        textmsg("no command in time: ", command[0])
        break
    limit_s = command[1] / 1000.0
    mode = command[9]
    if mode == 3 and command[2] == 1:
        left = command[3]
        total = left
        mover = start_thread(follow, ())
    elif mode == 4:
        speedl(six(command, 2), 40.0, get_steptime())

stop_thread(helper)
join_thread(helper)
stop_thread(mover)
join_thread(mover)
stopj(8.0)
socket_close("commands")
socket_close("points")
socket_close("equipment")
"""

PROGRAM: Final = "def control():\n" + "".join(f"\t{line}\n" for line in BODY.split("\n")) + "end\n"
"""As it is uploaded: every line behind a tab, the empty ones too."""
