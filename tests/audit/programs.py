"""Programs whose runs are recorded, with what can be changed in each."""

MOVES = """def main():
  movej([0.1, -1.6, -1.5, -1.5, 1.5, 0.2], a=8, v=2.0)
  set_standard_digital_out(3, True)
  sleep(0.1)
  movej([0.4, -1.6, -1.5, -1.5, 1.5, 0.2], a=8, v=1.0, r=0.03)
  movej([0.4, -1.4, -1.3, -1.5, 1.5, 0.2], a=8, v=0.8)
  set_standard_digital_out(3, False)
  write_output_float_register(1, 2.5)
  movel(pose_trans(get_target_tcp_pose(), [0, 0, 0.03, 0, 0, 0]), a=3, v=0.3)
  sleep(0.05)
end
main()
"""

LOOP = """def main():
  i = 0
  while i < 3:
    movej([0.1, -1.5, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)
    set_standard_digital_out(4, True)
    sleep(0.05)
    movej([0.0, -1.55, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)
    set_standard_digital_out(4, False)
    i = i + 1
  end
  if get_standard_digital_in(1):
    movej([0.2, -1.5, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)
  else:
    movej([-0.1, -1.5, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)
  end
  write_output_integer_register(5, i)
  sleep(0.05)
end
main()
"""

GRIPPER = """def main():
  movej([0.1, -1.5, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)
  set_standard_digital_out(0, True)
  while not get_standard_digital_in(2):
    sync()
  end
  movej([0.0, -1.55, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)
  set_standard_digital_out(0, False)
  while get_standard_digital_in(2):
    sync()
  end
  movej([0.1, -1.55, -1.5, -1.5, 1.5, 0.2], a=10, v=1.5)
end
main()
"""
