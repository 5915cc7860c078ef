"""Estimates of how probable it is that a requirement fails, with confidence."""
