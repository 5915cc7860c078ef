# A target seen through the hole of a ring that stands in the way.

import trimesh

ring = MeshShape(trimesh.creation.annulus(0.7, 1, 0.2, sections=64))
ego = new Object with viewAngles (120 deg, 60 deg), with visibleDistance 40
obstacle = new Object at (Range(-0.2, 0.2), 5, 0), facing (0, 90 deg, 0), with shape ring, with width 4, with length 4, with height 0.5
target = new Object at (Range(-0.5, 0.5), Range(9, 14), 0), facing Range(0, 360) deg
require ego can see target
