# A child behind a parked van, close to it.
ego = new Object at (0, 0), with width 2, with length 4.5, with requireVisible False
van = new Object at (Range(-40, 40), Range(5, 60)), with width 2.2, with length 6, with height 2.5
child = new Object at (Range(-40, 40), Range(5, 60)), with width 0.5, with length 0.5, with requireVisible False
require (distance from van to child) < 4
require child.y > van.y + 3.2
require abs(van.x - 4) < 1
