"""Visibility (section 11 of the specification): pure functions over columns of observers, targets and occluders.

``views`` says where observers look, ``hits`` what single rays meet, ``points`` and ``bodies`` decide whether targets
are seen, ``proofs`` prove without rays that they are not, and ``regions`` are the places in view.
"""
