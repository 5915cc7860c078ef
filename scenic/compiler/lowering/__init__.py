"""Lowering: the tree of a program to the tree of a Python module that builds its value graph when it runs.

The generated module speaks only to the object named ``__scenic__`` in its globals (the runtime's prelude) and to
names that the runtime provides as builtins. Python's own constructs pass through unchanged; parts of the tree that
hold nothing of Scenic's are shared with the input, which is never changed. Every generated node carries the place of
what it came from, so that ``co_positions`` of the compiled code points into the program.
"""

from scenic.compiler.lowering.program import lower

__all__ = ["lower"]
