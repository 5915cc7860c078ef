# Regions whose parameters are random, combined and chosen among.
center = Range(-5, 5) @ Range(-5, 5)
near = CircularRegion(center, Range(4, 6))
view = SectorRegion(center, Range(10, 12), Range(0, 360) deg, Range(60, 90) deg)
ego = new Object in Uniform(near, view), facing Range(0, 360) deg
other = new Object in view.difference(near)
third = new Object in RectangularRegion(center, Range(0, 3), Range(5, 9), 8).intersect(near)
