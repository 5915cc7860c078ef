"""CommonRoad files (XML, version 2020a) of scenes and simulations: lanelets, signs and lights, obstacles, a planning problem."""
