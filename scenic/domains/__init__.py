"""Domains: world models, each for a kind of scenarios."""
