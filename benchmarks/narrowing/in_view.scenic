# Two things that a camera with a narrow view has to see.
ego = new Object at (0, 0, 0), with visibleDistance 30, with viewAngle 60 deg
for i in range(2):
    new Object at (Range(-100, 100), Range(-100, 100), 0), with requireVisible True
