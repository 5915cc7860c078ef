"""Scenes as OpenUSD, with physics, materials, lights, cameras and semantic labels.

A scene is one layer. Its meshes are in the layer itself, or in layers of a shared folder that it refers to as instances.
"""

import hashlib
import math
from pathlib import Path
from typing import Any, Final

import numpy as np

from scenic.formats.colors import linear
from scenic.formats.imaging import MissingLibraryError
from scenic.formats.mesh_instances import surface_of
from scenic.formats.poses import Four
from scenic.formats.robotics.asset_files import FOLDER, image_file, mesh_name, texture_coordinates
from scenic.formats.robotics.mjcf import bottom, in_frame
from scenic.formats.robotics.solids import Solid, identifiers, solids_of
from scenic.formats.scene_cameras import Viewpoint
from scenic.formats.scene_protocols import Scene
from scenic.formats.scenery import scenery_of
from scenic.language.extras import needing

__all__ = ["require_usd", "usd", "usd_file"]

_APERTURE: Final = 20.955
"""Horizontal aperture of cameras, tenths of a scene unit, as other programs have it (millimetres of a film)."""

_CLIP: Final = (0.01, 1000.0)
"""Distances between which cameras see, metres."""

_ROUGHNESS: Final = 0.8


def require_usd() -> None:
    """Raise `MissingLibraryError` without the package ``usd-core``."""
    with needing("OpenUSD files need the package usd-core", "usd", kind=MissingLibraryError):
        import pxr.Usd  # noqa: F401 - optional


def usd(scene: Scene, name: str) -> dict[str, bytes]:
    """Return the files of a scene by their paths: its own layer as text, then the layers of meshes, and images.

    Args:
        scene: the scene.
        name: of its own file, which ends in ``.usda`` or ``.usdc``.

    """
    return _Writer(scene, inline=False).files(name)


def usd_file(scene: Scene, name: str) -> dict[str, bytes]:
    """Return one file with all meshes, ``.usda``, ``.usdc`` or ``.usdz``; images stand beside it unless it ends in ``.usdz``."""
    if not name.endswith(".usdz"):
        return _Writer(scene, inline=True).files(name)
    from tempfile import TemporaryDirectory

    from pxr import UsdUtils

    layer = f"{name.removesuffix('.usdz')}.usdc"
    with TemporaryDirectory() as folder:
        for path, content in _Writer(scene, inline=True).files(layer).items():
            target = Path(folder, path)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(content)
        UsdUtils.CreateNewUsdzPackage(str(Path(folder, layer)), str(Path(folder, name)))
        return {name: Path(folder, name).read_bytes()}


class _Writer:
    def __init__(self, scene: Scene, *, inline: bool) -> None:
        require_usd()
        from pxr import Sdf, Usd, UsdGeom, UsdPhysics

        self._scene = scene
        self._inline = inline
        self._assets: dict[str, bytes] = {}
        self._references: list[tuple[str, str, str]] = []
        """Paths of prims with the files and the prims that they refer to."""
        self._materials: dict[Any, Any] = {}
        self._frictions: dict[Any, Any] = {}
        self._layer = Sdf.Layer.CreateAnonymous(".usda")
        self._stage = Usd.Stage.Open(self._layer)
        UsdGeom.SetStageMetersPerUnit(self._stage, 1.0)
        UsdGeom.SetStageUpAxis(self._stage, UsdGeom.Tokens.z)
        UsdPhysics.SetStageKilogramsPerUnit(self._stage, 1.0)
        world = UsdGeom.Xform.Define(self._stage, "/World").GetPrim()
        self._stage.SetDefaultPrim(world)
        Usd.ModelAPI(world).SetKind("assembly")
        self._layer.customLayerData = {
            "scenic": {
                "seed": str(scene.seed),
                "k": int(scene.k),
                "digest": str(getattr(scene, "digest", "")),
            }
        }

    def files(self, name: str) -> dict[str, bytes]:
        solids = tuple(solid.without_ellipsoid for solid in solids_of(self._scene))
        self._surroundings(solids)
        free_names = iter(
            identifiers(iter(["Looks", "Sun", "Sky", "PhysicsScene", "Ground", *(s.name for s in solids)]))
        )
        names = list(free_names)[5:]
        for solid, label in zip(solids, names, strict=True):
            self._solid(solid, f"/World/{label}")
        # A stage would look for the files of references, which are not written yet.
        self._stage = None
        self._refer()
        return {name: _encoded(self._layer, name), **self._assets}

    def _refer(self) -> None:
        """Let prims be instances of the meshes in other files; those with opinions of their own are copies."""
        from pxr import Sdf

        for path, file, target in self._references:
            spec = self._layer.GetPrimAtPath(path)
            spec.referenceList.prependedItems.append(Sdf.Reference(file, target))
            spec.instanceable = not spec.nameChildren

    # The world

    def _surroundings(self, solids: tuple[Solid, ...]) -> None:
        from pxr import Gf, UsdGeom, UsdLux, UsdPhysics

        physics = UsdPhysics.Scene.Define(self._stage, "/World/PhysicsScene")
        physics.CreateGravityDirectionAttr(Gf.Vec3f(0, 0, -1))
        physics.CreateGravityMagnitudeAttr(9.81)
        UsdGeom.Scope.Define(self._stage, "/World/Looks")
        scenery = scenery_of(self._scene.params)
        sun = UsdLux.DistantLight.Define(self._stage, "/World/Sun")
        sun.CreateIntensityAttr(3000.0 * scenery.sunlight)
        sun.CreateExposureAttr(math.log2(scenery.exposure))
        sun.CreateAngleAttr(0.53)
        # A distant light shines along its own -Z.
        x, y, z = (float(value) for value in scenery.sun)
        _place(sun, (0.0, 0.0, 0.0), _turn_from_up(x, y, z))
        sky = UsdLux.DomeLight.Define(self._stage, "/World/Sky")
        sky.CreateIntensityAttr(500.0 * scenery.skylight)
        sky.CreateExposureAttr(math.log2(scenery.exposure))
        sky.CreateColorAttr(Gf.Vec3f(*_linear(scenery.zenith)))
        ground = UsdGeom.Plane.Define(self._stage, "/World/Ground")
        ground.CreateAxisAttr(UsdGeom.Tokens.z)
        ground.CreateWidthAttr(100.0)
        ground.CreateLengthAttr(100.0)
        ground.CreateExtentAttr([Gf.Vec3f(-50, -50, 0), Gf.Vec3f(50, 50, 0)])
        ground.CreatePurposeAttr(UsdGeom.Tokens.guide)
        lowest = min((bottom(solid) for solid in solids), default=0.0)
        _place(ground, (0.0, 0.0, min(0.0, lowest)), (0.0, 0.0, 0.0, 1.0))
        UsdPhysics.CollisionAPI.Apply(ground.GetPrim())

    # Objects

    def _solid(self, solid: Solid, path: str) -> None:
        from pxr import Gf, Usd, UsdGeom, UsdPhysics

        holder = UsdGeom.Xform.Define(self._stage, path)
        prim = holder.GetPrim()
        Usd.ModelAPI(prim).SetKind("component")
        _place(holder, solid.position, solid.quaternion)
        _label(prim, "class", solid.category)
        _label(prim, "name", solid.name)
        prim.SetCustomDataByKey("scenic", _custom(solid))
        if not solid.is_static:
            UsdPhysics.RigidBodyAPI.Apply(prim)
            self._mass(prim, solid)
        geometry = self._geometry(solid, f"{path}/geometry")
        if not solid.is_rendered:
            UsdGeom.Imageable(geometry).CreateVisibilityAttr(UsdGeom.Tokens.invisible)
        self._appearance(geometry, solid)
        if solid.collides:
            touching = geometry
            if solid.form in ("cylinder", "cone"):
                touching = self._round(f"{path}/collision", solid, solid.touching_radius)
                UsdGeom.Imageable(touching).CreatePurposeAttr(UsdGeom.Tokens.guide)
            if self._inline or solid.form != "mesh":  # shared meshes touch already
                _touching(touching, solid)
            self._friction(touching, solid)
        for camera, label in zip(
            solid.cameras, identifiers(camera.name for camera in solid.cameras), strict=True
        ):
            is_name_taken = label in ("geometry", "collision")
            self._camera(solid, camera, f"{path}/{'camera_' if is_name_taken else ''}{label}", Gf)

    def _mass(self, prim: object, solid: Solid) -> None:
        from pxr import Gf, UsdPhysics
        from scipy.spatial.transform import Rotation

        api = UsdPhysics.MassAPI.Apply(prim)
        api.CreateMassAttr(solid.inertia.mass)
        api.CreateCenterOfMassAttr(Gf.Vec3f(*solid.inertia.center.tolist()))
        moments, axes = np.linalg.eigh(solid.inertia.matrix)
        if np.linalg.det(axes) < 0:
            axes[:, 0] *= -1
        x, y, z, w = Rotation.from_matrix(axes).as_quat().tolist()
        api.CreateDiagonalInertiaAttr(Gf.Vec3f(*np.maximum(moments, 0).tolist()))
        api.CreatePrincipalAxesAttr(Gf.Quatf(w, x, y, z))

    def _geometry(self, solid: Solid, path: str) -> Any:
        """Return the prim of the object's form."""
        from pxr import Gf, UsdGeom

        width, length, height = solid.size
        half = Gf.Vec3f(width / 2, length / 2, height / 2)
        extent = [-half, half]
        match solid.form:
            case "box":
                cube = UsdGeom.Cube.Define(self._stage, path)
                cube.CreateSizeAttr(1.0)
                cube.CreateExtentAttr([Gf.Vec3f(-0.5), Gf.Vec3f(0.5)])
                cube.AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*solid.size))
                return cube.GetPrim()
            case "sphere":
                sphere = UsdGeom.Sphere.Define(self._stage, path)
                sphere.CreateRadiusAttr(width / 2)
                sphere.CreateExtentAttr(extent)
                return sphere.GetPrim()
            case "cylinder" | "cone":
                return self._round(path, solid, width / 2)
        return self._mesh(solid, path)

    def _round(self, path: str, solid: Solid, radius: float) -> Any:
        """Return the prim of a cylinder or cone of a radius."""
        from pxr import Gf, UsdGeom

        half = Gf.Vec3f(radius, radius, solid.size[2] / 2)
        kind = UsdGeom.Cylinder if solid.form == "cylinder" else UsdGeom.Cone
        form = kind.Define(self._stage, path)
        form.CreateRadiusAttr(radius)
        form.CreateHeightAttr(solid.size[2])
        form.CreateAxisAttr(UsdGeom.Tokens.z)
        form.CreateExtentAttr([-half, half])
        return form.GetPrim()

    def _mesh(self, solid: Solid, path: str) -> Any:
        """Return the prim of a mesh: defined here, or an instance of the shared one."""
        from pxr import Gf, UsdGeom, UsdPhysics

        if self._inline:
            prim = _define_mesh(self._stage, path, solid, solid.size)
        else:
            name = mesh_name(solid.mesh)
            if solid.texture is not None:
                # An image that is repeated has other coordinates at each size.
                name += f"_{hashlib.sha256(texture_coordinates(solid).tobytes()).hexdigest()[:12]}"
            file = f"{FOLDER}/{name}.usdc"
            if file not in self._assets:
                self._assets[file] = _mesh_layer(solid, name)
            prim = UsdGeom.Xform.Define(self._stage, path).GetPrim()
            self._references.append((path, f"./{file}", f"/{name}"))
            if not solid.collides:
                over = self._stage.OverridePrim(f"{path}/mesh")
                UsdPhysics.CollisionAPI(over).CreateCollisionEnabledAttr(False)
        UsdGeom.Xformable(prim).AddScaleOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*solid.size))
        return prim

    # Appearance

    def _appearance(self, geometry: object, solid: Solid) -> None:
        from pxr import Sdf, UsdGeom, UsdShade

        red, green, blue, alpha = solid.color
        primvars = UsdGeom.PrimvarsAPI(geometry)
        color = primvars.CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray)
        color.Set([tuple(_linear((red, green, blue)))])
        primvars.CreatePrimvar("displayOpacity", Sdf.ValueTypeNames.FloatArray).Set([alpha])
        image = None if solid.texture is None else image_file(solid.texture)
        key = (solid.color, None if image is None else image[0])
        if key not in self._materials:
            self._materials[key] = self._material(len(self._materials), solid.color, image)
        UsdShade.MaterialBindingAPI.Apply(geometry).Bind(self._materials[key])

    def _material(self, number: int, color: Four, image: tuple[str, bytes] | None) -> Any:
        from pxr import Gf, Sdf, UsdShade

        path = f"/World/Looks/look_{number}"
        material = UsdShade.Material.Define(self._stage, path)
        shader = UsdShade.Shader.Define(self._stage, f"{path}/surface")
        shader.CreateIdAttr("UsdPreviewSurface")
        diffuse = shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f)
        shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(_ROUGHNESS)
        shader.CreateInput("metallic", Sdf.ValueTypeNames.Float).Set(0.0)
        shader.CreateInput("opacity", Sdf.ValueTypeNames.Float).Set(color[3])
        diffuse.Set(Gf.Vec3f(*_linear(color[:3])))
        if image is not None:
            file, self._assets[image[0]] = image[0], image[1]
            reader = UsdShade.Shader.Define(self._stage, f"{path}/coordinates")
            reader.CreateIdAttr("UsdPrimvarReader_float2")
            reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
            reader_output = reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
            texture = UsdShade.Shader.Define(self._stage, f"{path}/image")
            texture.CreateIdAttr("UsdUVTexture")
            texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(Sdf.AssetPath(f"./{file}"))
            texture.CreateInput("sourceColorSpace", Sdf.ValueTypeNames.Token).Set("sRGB")
            for axis in ("wrapS", "wrapT"):
                texture.CreateInput(axis, Sdf.ValueTypeNames.Token).Set("repeat")
            texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(reader_output)
            diffuse.ConnectToSource(texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3))
        material.CreateSurfaceOutput().ConnectToSource(
            shader.CreateOutput("surface", Sdf.ValueTypeNames.Token)
        )
        return material

    def _friction(self, geometry: object, solid: Solid) -> None:
        from pxr import UsdPhysics, UsdShade

        key = (solid.friction, solid.restitution)
        if key == (None, None):
            return
        if key not in self._frictions:
            path = f"/World/Looks/contact_{len(self._frictions)}"
            material = UsdShade.Material.Define(self._stage, path)
            api = UsdPhysics.MaterialAPI.Apply(material.GetPrim())
            if solid.friction is not None:
                api.CreateStaticFrictionAttr(solid.friction)
                api.CreateDynamicFrictionAttr(solid.friction)
            if solid.restitution is not None:
                api.CreateRestitutionAttr(solid.restitution)
            self._frictions[key] = material
        UsdShade.MaterialBindingAPI.Apply(geometry).Bind(
            self._frictions[key], UsdShade.Tokens.weakerThanDescendants, "physics"
        )

    def _camera(self, solid: Solid, viewpoint: Viewpoint, path: str, gf: Any) -> None:
        from pxr import UsdGeom

        camera = UsdGeom.Camera.Define(self._stage, path)
        place, turn = in_frame(solid, viewpoint)
        _place(camera, tuple(place.tolist()), tuple(turn.tolist()))
        across, upward = viewpoint.camera.tangents
        camera.CreateHorizontalApertureAttr(_APERTURE)
        camera.CreateVerticalApertureAttr(_APERTURE * upward / across)
        camera.CreateFocalLengthAttr(_APERTURE / (2 * across))
        camera.CreateClippingRangeAttr(gf.Vec2f(*_CLIP))
        camera.GetPrim().SetCustomDataByKey(
            "scenic", {"width": viewpoint.size[0], "height": viewpoint.size[1], "name": viewpoint.name}
        )


def _place(prim: Any, position: tuple[float, ...], quaternion: tuple[float, ...]) -> None:
    from pxr import Gf, UsdGeom

    x, y, z, w = quaternion
    prim.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Vec3d(*position))
    prim.AddOrientOp(UsdGeom.XformOp.PrecisionDouble).Set(Gf.Quatd(w, x, y, z))


def _turn_from_up(x: float, y: float, z: float) -> Four:
    """Return the shortest rotation that takes +Z to a unit vector."""
    quaternion = np.array([-y, x, 0.0, 1.0 + z])
    length = float(np.linalg.norm(quaternion))
    if length < 1e-9:
        return 1.0, 0.0, 0.0, 0.0
    a, b, c, d = (quaternion / length).tolist()
    return a, b, c, d


def _label(prim: object, kind: str, text: str) -> None:
    """Add a semantic label; versions of the library before 24.11 have no schema of labels."""
    from pxr import UsdSemantics

    UsdSemantics.LabelsAPI.Apply(prim, kind).CreateLabelsAttr([text])


def _custom(solid: Solid) -> dict[str, Any]:
    """Return the properties of an object that are numbers, texts or vectors, as data of its prim."""
    found: dict[str, Any] = {"class": solid.class_name, "index": solid.index}
    for name, value in solid.thing.properties.items():
        plain = _plain(value)
        if plain is not None:
            found[name] = plain
    return found


def _plain(value: object) -> Any:
    """Return a value as custom data has it; ``None`` if it cannot."""
    from pxr import Gf

    if isinstance(value, bool | str):
        return value
    if isinstance(value, int):
        return value if abs(value) < 2**31 else float(value)
    if isinstance(value, float):
        return value
    if hasattr(value, "x") and hasattr(value, "y") and hasattr(value, "z") and not hasattr(value, "w"):
        return Gf.Vec3d(float(value.x), float(value.y), float(value.z))
    return None


def _linear(color: tuple[float, ...]) -> list[float]:
    return [float(part) for part in linear(np.array(color))]


def _define_mesh(stage: object, path: str, solid: Solid, size: tuple[float, float, float]) -> Any:
    """Return a mesh in the unit box, with normals of every corner and texture coordinates where the object has an image.

    Edges are sharp or smooth as at a size.
    """
    from pxr import Gf, Sdf, UsdGeom, Vt

    mesh = UsdGeom.Mesh.Define(stage, path)
    surface = surface_of(solid.mesh, size)
    faces = np.asarray(surface.faces, np.int32)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(surface.vertices.astype(np.float32)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(faces.ravel()))
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    mesh.CreateExtentAttr([Gf.Vec3f(*low.tolist()), Gf.Vec3f(*high.tolist())])
    normals = surface.normals[faces.ravel()].astype(np.float32)
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    if solid.texture is not None:
        coordinates = texture_coordinates(solid).reshape(-1, 2).astype(np.float32)
        primvars = UsdGeom.PrimvarsAPI(mesh.GetPrim())
        st = primvars.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying)
        st.Set(Vt.Vec2fArray.FromNumpy(coordinates))
    return mesh.GetPrim()


def _touching(geometry: object, solid: Solid) -> None:
    """Let a prim touch others: a mesh by its convex hull or parts."""
    from pxr import UsdPhysics

    UsdPhysics.CollisionAPI.Apply(geometry)
    if solid.form == "mesh":
        approximation = UsdPhysics.Tokens.convexDecomposition
        if getattr(solid.mesh, "is_convex", False):
            approximation = UsdPhysics.Tokens.convexHull
        UsdPhysics.MeshCollisionAPI.Apply(geometry).CreateApproximationAttr(approximation)


def _mesh_layer(solid: Solid, name: str) -> bytes:
    """Return the layer of one mesh."""
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    holder = UsdGeom.Xform.Define(stage, f"/{name}")
    stage.SetDefaultPrim(holder.GetPrim())
    # Objects of all sizes share it.
    _touching(_define_mesh(stage, f"/{name}/mesh", solid, (1.0, 1.0, 1.0)), solid)
    return _encoded(stage.GetRootLayer(), "mesh.usdc")


def _encoded(layer: Any, name: str) -> bytes:
    """Return the content of a layer's file: text, or binary by the name's ending."""
    if name.endswith(".usda"):
        text: str = layer.ExportToString()
        return text.encode()
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        path = Path(folder, "layer.usdc")
        layer.Export(str(path))
        return path.read_bytes()
