"""The script of a task, as a pendant generates it: `writing` holds lines, `generating` the table of kinds."""
