"""Photographs of a simulated site by a drone's camera: textured ground and stones, no machine."""

from collections.abc import Iterator, Sequence

import mujoco
import numpy as np
from executive_plugins.robot.mujoco.site.site import Site, add_daylight
from executive_plugins.robot.mujoco.site.surface_texture import (
    TexturedMesh,
    ground_skin,
    stone_skin,
)
from numpy.typing import NDArray

from executive.arrays import Float
from executive.errors import RobotError
from executive.geometry.pose import transform
from executive.geometry.rotation import quaternion_wxyz

_CAMERA = "drone"
# From MuJoCo's camera (x right, y up, z backward) to the optical frame (x right, y down, z
# forward).
_R_OPTICAL_CAMERA = np.diag([1.0, -1.0, -1.0])


def photograph_site(
    site: Site,
    T_world_stones: Sequence[Float],
    T_world_opticals: Sequence[Float],
    size_px: tuple[int, int],
    view_angle_rad: float,
) -> Iterator[NDArray[np.uint8]]:
    """Yield the picture of a pinhole camera from each pose, see `Photographer`.

    Ground and stones are built into a separate world, so that textures influence neither physics
    nor lidars. The machine is not in it, since a survey is flown before it arrives. Equal sites
    have equal textures.

    Raises:
        RobotError: If this computer cannot render off screen; the message names the cure.
    """
    width, height = size_px
    model = _world(site, T_world_stones, size_px)
    model.cam_fovy[0] = np.degrees(2 * np.arctan(np.tan(view_angle_rad / 2) * height / width))
    data = mujoco.MjData(model)
    screen = _screen(size_px)
    try:
        context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
        for T_world_optical in T_world_opticals:
            model.cam_pos[0] = T_world_optical[:3, 3]
            model.cam_quat[0] = quaternion_wxyz(T_world_optical[:3, :3] @ _R_OPTICAL_CAMERA)
            mujoco.mj_forward(model, data)
            yield _drawn(model, data, context, size_px)
        context.free()
    finally:
        screen.free()


def _drawn(
    model: mujoco.MjModel, data: mujoco.MjData, context: mujoco.MjrContext, size_px: tuple[int, int]
) -> NDArray[np.uint8]:
    camera = mujoco.MjvCamera()
    camera.type, camera.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, 0
    scene = mujoco.MjvScene(model, maxgeom=model.ngeom)
    mujoco.mjv_updateScene(
        model, data, mujoco.MjvOption(), None, camera, mujoco.mjtCatBit.mjCAT_ALL, scene
    )
    view = mujoco.MjrRect(0, 0, *size_px)
    picture = np.empty((size_px[1], size_px[0], 3), dtype=np.uint8)
    mujoco.mjr_render(view, scene, context)
    mujoco.mjr_readPixels(picture, None, view, context)
    return np.ascontiguousarray(picture[::-1])  # OpenGL rows start at the bottom


def _screen(size_px: tuple[int, int]) -> "mujoco.egl.GLContext":
    """Return an off-screen rendering context, made current."""
    try:
        from mujoco.egl import GLContext  # loads a system library at import

        screen = GLContext(*size_px)
        screen.make_current()
    except (ImportError, AttributeError, RuntimeError, OSError) as error:
        raise RobotError(
            f"no photographs: this computer cannot render off screen ({error}); "
            "install EGL, on Debian: "
            "apt-get install libegl1 libgl1 libgl1-mesa-dri"
        ) from error
    return screen


def _world(site: Site, T_world_stones: Sequence[Float], size_px: tuple[int, int]) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    rng = np.random.default_rng(
        np.frombuffer(site.terrain.heights_m[:8].tobytes(), dtype=np.uint32)
    )
    add_daylight(spec)
    _add(spec, "ground", ground_skin(site.terrain.mesh(), rng))
    for stone, T_world_stone in zip(site.stones, T_world_stones, strict=True):
        skin = stone_skin((stone.vertices, stone.triangles), rng)
        moved = transform(T_world_stone, stone.vertices)
        _add(
            spec, stone.name, TexturedMesh((moved, stone.triangles), skin.coordinates, skin.texture)
        )
    spec.worldbody.add_camera(name=_CAMERA)
    spec.visual.global_.offwidth, spec.visual.global_.offheight = size_px
    spec.visual.map.znear = 0.001
    return spec.compile()


def _add(spec: mujoco.MjSpec, name: str, skin: TexturedMesh) -> None:
    """Add a surface that is only visible and does not collide."""
    vertices, triangles = skin.mesh
    height, width, _ = skin.texture.shape
    texture = spec.add_texture(
        name=name, type=mujoco.mjtTexture.mjTEXTURE_2D, width=width, height=height, nchannel=3
    )
    texture.data = skin.texture[::-1].tobytes()
    material = spec.add_material(name=name, specular=0.0)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name
    spec.add_mesh(
        name=name,
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        uservert=vertices.ravel(),
        userface=triangles.ravel().astype(np.int32),
        usertexcoord=skin.coordinates.ravel(),
        userfacetexcoord=np.arange(triangles.size, dtype=np.int32),
    )
    geom = spec.worldbody.add_geom(
        name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, material=name
    )
    geom.contype = geom.conaffinity = 0
