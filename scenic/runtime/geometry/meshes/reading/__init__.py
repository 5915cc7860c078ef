"""Readers of the common mesh formats: from the bytes of a file to vertices and triangles, by NumPy alone.

Each reader is a function of the file's bytes. It raises `ValueError` with a reason where the file breaks its format,
and `NotCoveredError` where the file uses a part of the format that the reader leaves to trimesh, which takes half a
second to import.
"""
