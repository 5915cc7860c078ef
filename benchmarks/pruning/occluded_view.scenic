# Something just inside the narrow view of a camera.
ego = new Object at (0, 0), with viewAngle 20 deg, with visibleDistance 30
target = new Object at (Range(-100, 100), Range(-100, 100)), with requireVisible True
require (distance from ego to target) > 25
