"""Exact batched geometry on plain arrays.

An *entry* is one combination of lane and object, or of lane and pair of objects. Every function answers for
an entry bitwise alike whatever the other entries of its batch are: operations are elementwise, sums over the
three coordinates are written out, and reductions over faces run over one entry at a time. Nothing here knows
the value graph or the classes of the language.

Meshes are immutable *unit meshes* (`mesh`); what is derived of one (trees, cells, grids) is made once in its unit
frame and serves all sizes and poses. A `Body` is a mesh number and a pose for each lane (`bodies`, `poses`), a
`Crowd` many of them as flat arrays (`crowd`).

- Files to meshes: `loading` and `reading`, `solids` (a proper volume or a refusal), `topology`; `store` keeps what is
  dear to compute on disk.
- Collision, cheap tests first: `collision` leads through world boxes in cells and oriented boxes (`broadphase`),
  cells of solids (`proofs`, `voxels`, `cells`), then faces (`narrowphase`, `contact`, `facetree`, `triangles`).
- Points and bodies in solids and polygons: `inside`, `containment`, `polygons`; distances: `nearest`, `distance`.
- Surfaces: `surface` (sides, drawing points), `projection` and `facegrid` (where things land).
- Sight: `visibility`, `embree`.
"""
