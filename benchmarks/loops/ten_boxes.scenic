# Ten boxes somewhere in a cube of 100 m, all facing its middle.
workspace = Workspace(BoxRegion(dimensions=(100, 100, 100)))
for _ in range(10):
    new Object in workspace, facing directly toward (0, 0, 0), with regionContainedIn everywhere
