# The bearing to the dock within 2 degrees.
ego = new Object at (Range(-50, 50), Range(-50, 50))
dock = new Object at (40, 30)
require abs(angle from ego to dock) < 2 deg
require (distance from ego to dock) > 20
