"""Search for scenes and simulations in which requirements fail."""
