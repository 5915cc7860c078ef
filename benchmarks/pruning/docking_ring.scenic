# At a distance of 10 to 10.5 from the station, in front of it.
ego = new Object at (0, 0, 0)
craft = new Object at (Range(-50, 50), Range(-50, 50), Range(-50, 50))
require 10 < (distance from ego to craft) < 10.5
require craft.y > 9
