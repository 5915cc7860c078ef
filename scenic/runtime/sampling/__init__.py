"""From a plan of checks to scenes: streams of points of the cube, the order of checks, the engine."""
