# Seats in rows of seven, three left over, and rows of five, two left over.
seats = DiscreteRange(1, 400)
require seats % 7 == 3
require seats % 5 == 2
require seats > 300
param seats = seats
