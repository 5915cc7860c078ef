# A ship comes to its berth: place, heading and speed.
dock = (50, 20)
ship = new Object at (Range(0, 100), Range(0, 100)), facing Range(0, 360) deg, with width 4, with length 12
speed = Range(0, 10)
require (distance from ship to dock) < 4
require abs(ship.heading - 1.2) < 0.1
require speed < 0.5
param speed = speed
