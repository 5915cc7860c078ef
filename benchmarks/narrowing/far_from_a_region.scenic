# A place close to a disc, looked for in a wide square.
region = CircularRegion((10, 0), 5)
ego = new Object at (Range(-100, 100), Range(-100, 100), 0)
require (distance from ego to region) < 3
