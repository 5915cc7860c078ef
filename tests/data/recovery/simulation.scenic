"""A small world with its own rules."""
import random as chance

simulator DummySimulator(drift=0.1)
param timestep = 0.1, seedless = True

class Actor(Object):
    speed: Range(1, 2)
    energy: 100
    goals: []

    def tick(self, amount):
        self.energy -= amount
        return self.energy > 0

behavior Act(plan):
    precondition: len(plan) > 0
    invariant: self.energy > 0
    for kind, amount in plan:
        match kind:
            case "walk":
                do Move(amount)
            case "rest" | "sleep":
                wait for amount steps
            case other if amount > 3:
                print(f"unknown: {other}")
            case _:
                abort_plan(plan)
                return
    terminate

def abort_plan(plan):
    while plan:
        plan.pop()

behavior Move(amount):
    start = self.position
    while (distance from self to start) < amount:
        take ("move", self.speed)
        self.tick(0.1)
        if not self.tick(0):
            terminate

monitor Energy(actors):
    while any(actor.energy > 0 for actor in actors):
        wait
    terminate simulation

class DummySimulator(object):
    def __init__(self, drift=0.0):
        self.drift = drift

    def step(self, actions):
        return [(action, chance.random() * self.drift) for action in actions]

PLAN = [("walk", 3), ("rest", 2), ("walk", 5)]
ego = new Actor at (0, 0, 0), with behavior Act(PLAN)
friend = new Actor right of ego by Range(2, 3),
    facing ego.heading + 10 deg,
    with behavior Act(PLAN[1:]),
    with goals ["meet", "eat"]
stranger = new Actor visible from ego,
    with behavior Act([("rest", 10)])
hidden = new Actor not visible from ego, with energy 50
require monitor Energy([ego, friend])
require friend.speed > 1.2
require[0.9] (distance from friend to stranger) > 2
require always ego.energy > -1
record ego.energy every 5 steps as energy
terminate after 100 steps
