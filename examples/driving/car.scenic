"""A car somewhere on the road: the smallest driving program."""

param map = localPath('crossing.xodr')
model scenic.simulators.newtonian.driving_model

ego = new Car
