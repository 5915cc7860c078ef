# Classes with defaults that depend on each other, and relations between instances.
class Vehicle:
    wheelbase: Range(2.4, 3)
    length: self.wheelbase + 1.5
    width: 1.8
    gap: Range(1, 4)
class Truck(Vehicle):
    width: 2.4
    trailer[additive]: Range(4, 6)
class Van(Truck):
    trailer[additive]: 1
ego = new Vehicle at (0, Range(-2, 2))
lead = new Van ahead of ego by ego.gap, facing Range(-5, 5) deg
side = new Truck left of lead by Range(0.5, 1.5)
rear = new Vehicle behind ego by Range(2, 5), facing toward ego
require (relative heading of lead) < 0.05
require lead.trailer[0] < side.trailer[0]
