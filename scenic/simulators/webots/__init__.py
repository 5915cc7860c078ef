"""Webots: the world model, and the side of a supervisor that runs simulations.

Written against the documented interface of Webots R2023a; nothing here needs Webots to compile and sample.
"""
