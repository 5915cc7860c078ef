# Two things that hardly leave a gap.
ego = new Object at (Range(-50, 50), Range(-50, 50), 0)
other = new Object at (Range(-50, 50), Range(-50, 50), 0)
require (distance from ego to other) < 2
