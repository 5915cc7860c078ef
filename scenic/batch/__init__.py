"""Many scenes and simulations: made by several processes, in order, and kept in files."""
