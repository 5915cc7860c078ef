"""Conversion of programs of Scenic 2 to Scenic 3, without running them.

`converting.convert` converts one text; `migrated_files` reads, converts and writes files; `embedded` finds programs in strings.
"""
