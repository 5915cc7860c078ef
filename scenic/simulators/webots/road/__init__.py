"""Road traffic in Webots."""
