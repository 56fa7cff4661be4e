"""Textures of ground and stones in photographs, rich enough for structure from motion."""

from dataclasses import dataclass

import numpy as np
from executive_plugins.robot.mujoco.site.ray_mesh import Mesh
from numpy.typing import NDArray
from scipy.fft import irfft2, rfft2

from executive.arrays import Float, Int

Image = NDArray[np.uint8]
_TEXEL_M = 0.004  # texel of a stone; pixels of a photograph from 8 m are about 1 cm
_GROUND_TEXEL_M, _GROUND_TEXELS = 0.0075, 4096  # and largest number along a side, for memory
_FALL = 0.9  # amplitude falls with frequency to this power, as in natural images
_CONTRAST = (0.26, 0.28, 0.32)  # of red, green and blue; dark areas are warmer
_GROUND_RGB, _STONE_RGB = (134, 112, 86), (158, 156, 150)


@dataclass(frozen=True, slots=True, eq=False)
class TexturedMesh:
    """A textured surface.

    Attributes:
        mesh: Vertices [m] and triangles.
        coordinates: Texture coordinates of each triangle's corners, 0 … 1, shape (3 F, 2).
        texture: Red, green, blue, shape (height, width, 3).
    """

    mesh: Mesh
    coordinates: Float
    texture: Image


def ground_skin(mesh: Mesh, rng: np.random.Generator) -> TexturedMesh:
    """Project one texture onto the ground from above.

    It does not repeat, since repetitions would be matched with each other.
    """
    corners = _corners(mesh)[:, :2]
    low, high = corners.min(axis=0), corners.max(axis=0)
    side = min(_GROUND_TEXELS, int(np.ceil((high - low).max() / _GROUND_TEXEL_M)))
    return TexturedMesh(
        mesh, (corners - low) / (high - low), _mottled((side, side), _GROUND_RGB, rng)
    )


def stone_skin(mesh: Mesh, rng: np.random.Generator) -> TexturedMesh:
    """Texture a stone by box projection.

    Each triangle uses the face of a box that it faces most.
    """
    vertices, triangles = mesh
    low, size_m = vertices.min(axis=0), np.ptp(vertices, axis=0).max()
    side = int(np.ceil(size_m / _TEXEL_M))
    faces = _facing(vertices[triangles])
    axis, is_back = faces % 3, faces // 3
    corners = (_corners(mesh) - low).reshape(-1, 3, 3)
    along = np.stack([(axis + 1) % 3, (axis + 2) % 3], axis=1)[:, None, :]
    flat = (
        np.take_along_axis(corners, np.broadcast_to(along, (len(corners), 3, 2)), axis=2) / size_m
    )
    tile = np.stack([axis, is_back], axis=1)[:, None, :]
    coordinates = ((0.998 * flat + 0.001 + tile) / [3, 2]).reshape(-1, 2)
    return TexturedMesh(mesh, coordinates, _mottled((2 * side, 3 * side), _STONE_RGB, rng))


def _corners(mesh: Mesh) -> Float:
    vertices, triangles = mesh
    return np.asarray(vertices[triangles].reshape(-1, 3))


def _facing(corners: Float) -> Int:
    """Return the axis nearest to the normal of each triangle (F, 3, 3), shape (F,).

    It is 0 to 2 for x, y, z, and 3 to 5 for the negative directions.
    """
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    axis = np.abs(normals).argmax(axis=1)
    against = np.take_along_axis(normals, axis[:, None], axis=1)[:, 0] < 0
    return np.asarray(axis + 3 * against, dtype=np.int64)


def _mottled(shape: tuple[int, int], rgb: tuple[int, int, int], rng: np.random.Generator) -> Image:
    """Return noise around a colour."""
    noise = _noise(shape, rng)
    picture = np.empty((*shape, 3), dtype=np.uint8)
    for channel, (level, contrast) in enumerate(zip(rgb, _CONTRAST, strict=True)):
        picture[..., channel] = np.clip(level * (1 + contrast * noise), 0, 255)
    return picture


def _noise(shape: tuple[int, int], rng: np.random.Generator) -> NDArray[np.float32]:
    """Return noise of unit deviation whose amplitude falls with frequency (spectral synthesis)."""
    spectrum = rfft2(rng.standard_normal(shape, dtype=np.float32))
    frequency = np.hypot(np.fft.fftfreq(shape[0])[:, None], np.fft.rfftfreq(shape[1])).astype(
        np.float32
    )
    # Structures wider than an eighth of the picture are damped, so no side of it is all dark.
    noise = irfft2(spectrum / np.maximum(frequency, 8 / max(shape)) ** _FALL, shape)
    return np.asarray(noise / noise.std(), dtype=np.float32)
