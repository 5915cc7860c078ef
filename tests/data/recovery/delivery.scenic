import datetime as dt
from typing import List

DEPOT = (0, 0, 0)
STREETS = ["North", "South", "East"]
NOW = dt.datetime(2020, 1, 1, 12, 30)

class Van(Object):
    width: 2.2
    length: 5.5
    height: 2.4
    parcels: DiscreteRange(1, 9)
    plate: f"V-{self.parcels:03d}"

class House(Object):
    width: Range(8, 12)
    length: Range(8, 12)
    height: 6
    street: Uniform(*STREETS)
    number: DiscreteRange(1, 99)

def address(house: House, *, short: bool = False) -> str:
    if short:
        return f"{house.number}"
    else:
        return f"{house.street} {house.number}"

def plan(houses: List, start=DEPOT):
    order = sorted(houses, key=lambda house: house.number)
    legs, current = [], start
    for house in order:
        leg = (current, house.position)
        legs.append(leg)
        current = house.position
    return legs

behavior Deliver(legs, speed=8):
    delivered = 0
    for start, end in legs:
        do DriveTo(end, speed) for 5 * 60 seconds
        try:
            do Unload(2)
            delivered += 1
        interrupt when self.parcels == 0:
            break
    print(f"{delivered} delivered")
    do DriveTo(DEPOT, speed=speed * 1.5)

behavior DriveTo(target, speed):
    while (distance from self to target) > 2:
        take ("drive", speed, target)

behavior Unload(count):
    for number in range(count):
        wait for 30 seconds
    self.parcels -= count

houses = []
for street in STREETS:
    for number in range(3):
        house = new House at (number * 15, len(street) * 15, 3),
            with street street,
            with number number + 1
        houses.append(house)

legs = plan(houses)
ego = new Van at DEPOT,
    facing toward houses[0],
    with parcels len(houses),
    with behavior Deliver(legs, speed=Range(6, 10))
second = new Van behind ego by 2, with behavior Deliver(legs[::-1])
names = {address(house): house for house in houses}

require ego.parcels > 2
require len(names) == len(houses)
require eventually ego.parcels == 0
require (distance from ego to second) < 20
record ego.parcels every 10 seconds as parcels
terminate after 1000 steps
