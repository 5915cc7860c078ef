# A car cuts in with a short gap and higher speed.
lane = 3.5
ego = new Object at (0, Range(-100, 100)), with width 2, with length 4.5
cutter = new Object at (lane, Range(-100, 100)), with width 2, with length 4.5
egoSpeed, cutSpeed = Range(5, 40), Range(5, 40)
gap = cutter.y - ego.y
require 6 < gap < 12
require 2 < cutSpeed - egoSpeed < 4
param egoSpeed = egoSpeed, cutSpeed = cutSpeed
