"""Regions of space: where objects are placed, and what must contain them (section 9 of the specification)."""
