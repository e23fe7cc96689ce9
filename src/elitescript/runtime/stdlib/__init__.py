"""Modules that scripts import and that must not be the real ones.

locks       the lock, re-entrant lock and thread-local storage of script threads
thread      `_thread` over them
loader      private copies of installed pure-Python modules
clock       `time`
processes   `subprocess`
posix       `os`, `os.path`, `signal`
system      `sys`
chance      `random`
iteration   `itertools`, and iterators that would never come to a checkpoint
patterns    `re`
notation    `typing`
records     its classes of named tuples and of dicts
"""
