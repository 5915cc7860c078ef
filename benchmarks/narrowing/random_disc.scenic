# A thing in a disc that is random itself.
region = CircularRegion((Range(5, 10), 0), Range(4, 6))
ego = new Object at (Range(-100, 100), Range(-100, 100), 0)
require ego in region
