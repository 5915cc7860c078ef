# Fixed regions combined: exact polygons and solids.
ring = CircularRegion(0 @ 0, 20).difference(CircularRegion(0 @ 0, 8)).difference(SectorRegion(0 @ 0, 30, 0.5, 1))
hall = BoxRegion(dimensions=(9, 8, 6)).intersect(SpheroidRegion(dimensions=(10, 10, 8)))
ego = new Object in ring, facing Range(0, 360) deg
other = new Object in ring.intersect(RectangularRegion(0 @ 0, 0.3, 60, 12)), with regionContainedIn ring
balloon = new Object in hall, with width 0.5, with height 0.5
