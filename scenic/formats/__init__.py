"""Output formats of sampled scenes: JSON Lines, GLB, an HTML page, PNG images.

Everything here reads scenes through the protocols of :mod:`scenic.formats.scene_protocols` and writes complete files or
none. Nothing here samples, compiles or prints.
"""
