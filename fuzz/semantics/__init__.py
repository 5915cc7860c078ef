"""Typed programs, run from text to scenes and simulations: what must hold of every program that means something."""
