"""Intersections by their guideways, for traffic in Webots."""
