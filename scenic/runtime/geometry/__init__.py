"""Exact batched geometry on plain arrays.

An *entry* is one combination of lane and object, or of lane and pair of objects. Every function answers for
an entry bitwise alike whatever the other entries of its batch are: operations are elementwise, sums over the
three coordinates are written out, and reductions over faces run over one entry at a time. Nothing here knows
the value graph or the classes of the language.
"""
