# At one of the two ends of the room, both together.
a, b = Range(-50, 50), Range(-50, 50)
require abs(a) > 48 and abs(b) > 48
require a * b < 0
one = new Object at (a, 0)
two = new Object at (b, 5)
