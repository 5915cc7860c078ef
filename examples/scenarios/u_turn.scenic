"""U-turn: the ego turns round on a road of two lanes, forward and backward, and drives back."""

param map = localPath('../driving/crossing.xodr')
model scenic.simulators.newtonian.driving_model

road1 = network.elements['road1']
lane = road1.forwardLanes.lanes[0]
back = road1.backwardLanes.lanes[0]

behavior TurnRound():
    do FollowLaneBehavior(target_speed=6) until (distance from self to place) < 6
    do FollowLaneBehavior(target_speed=0.5) until self.speed < 1
    do UTurnBehavior()
    do FollowLaneBehavior(target_speed=6)

ego = new Car following roadDirection from lane.centerline[0] for 20, with speed 6, with behavior TurnRound(),
    with color (0.9, 0.75, 0.2)
place = new Point following roadDirection from ego for Range(20, 30)

record (distance from ego to road) as 'distance from the road'
require always (distance from ego to road) < 0.1 as 'the ego stays on the road'
require eventually ego._lane is back and ego.speed > 4 as 'the ego drives back'
terminate after 40 seconds
