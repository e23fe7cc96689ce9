"""Graphical programs: a tree of nodes from a `.task` file, its script, and edits that keep what is not understood.

Pure: bytes in, records, bytes and text out. `xml_text` keeps a file piece by piece, `kinds` says where the fields of
each kind of node stand in it, `task` reads and writes, `rows` numbers, `script` generates, `edits` change,
`configuration` reads what stands beside a task. Only `xml_text`, `fields`, `references` and `task` know XML.
"""

from elitescript.program_tree.configuration import Configuration, GlobalVariable, read_configuration, read_variables
from elitescript.program_tree.edits import insert, move, remove, replace, set_enabled
from elitescript.program_tree.rows import Row, place_of, rows_of
from elitescript.program_tree.script.generating import Generated, generated, script_of
from elitescript.program_tree.task import Task, nodes_in, read_task, task_bytes
from elitescript.program_tree.xml_text import TaskFileError

__all__ = [
    "Configuration",
    "Generated",
    "GlobalVariable",
    "Row",
    "Task",
    "TaskFileError",
    "generated",
    "insert",
    "move",
    "nodes_in",
    "place_of",
    "read_configuration",
    "read_task",
    "read_variables",
    "remove",
    "replace",
    "rows_of",
    "script_of",
    "set_enabled",
    "task_bytes",
]
