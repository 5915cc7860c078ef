"""A car steers by pure pursuit along points of its own, with a speed at each of them."""

param map = localPath('motorway.xodr')
model scenic.simulators.newtonian.driving_model

way = Trajectory([(0, -8.75), (60, -8.75), (110, -5.25), (380, -5.25)], speeds=[12, 12, 15, 15])

ego = new Car at (5, -8.75),
    facing roadDirection,
    with speed 12,
    with lateralController PurePursuitLateralController(lookahead=6),
    with behavior FollowTrajectoryBehavior(trajectory=way)
record ego.speed as speed
