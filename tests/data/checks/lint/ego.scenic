from math import pi
spot = (pi, 2)
box = new Object ahead of spot
other = new Object offset by spot
#                  ^^^^^^^^^^^^^^ SC209 `offset by` refers to the ego, which is not set yet
def near():
    return new Object ahead of ego
behavior B():
    take distance to self
class Car:
    position: ego offset by spot
ego = new Object at spot
new Object at ego offset by spot
print(box, other, near, B, Car)
