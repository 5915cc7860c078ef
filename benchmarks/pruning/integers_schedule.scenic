# Three buses whose departures are ten minutes apart.
start = [DiscreteRange(0, 59) for i in range(3)]
for one, other in zip(start, start[1:]):
    require other - one == 10
param start = start
