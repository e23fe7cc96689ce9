"""Running programs: script threads in virtual time, and everything that a script can reach.

Import the module you need; this package imports nothing by itself.

    strand      one script thread and how it is suspended
    timers      when waits end
    scheduler   whose turn it is: order, waiting, work per tick, stop
    host        a program and its secondary programs, as controller and robot see them
    secondary   secondary programs, one after the other
    program     the namespace and the resources of one run
    context     what a command's body may use
    bindings    the names that every script finds: commands and restricted built-ins
    sealed      classes whose insides scripts cannot reach
    guards      the built-ins that could look behind objects, kept from doing so
    facades     the modules that a script can import
    files       file objects for scripts
    world       what lies outside: the interface, and the names of files
    alarms      an exception as an alarm, with its place in the text
    stdlib      our own small modules, and private copies of installed ones
"""
