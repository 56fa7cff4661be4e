"""Settings of the surveying plugins, apart from them: reading a mission imports no algorithm."""

from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

from pydantic import Field

from executive.config import Meters, Radians, Settings
from executive.interfaces.declaration import PluginSettings, Refusal
from executive.machine.machine import Machine


class DepthSettings(Settings):
    """Resolution of the depth maps, and how strictly depths are tested."""

    pixel_m: Meters = Field(
        0.022, gt=0.001, le=1, description="A pixel of the depth maps on the ground [m]."
    )
    window_px: int = Field(
        5, ge=3, le=21, description="Side of the window that is compared [px]; odd."
    )
    compared: int = Field(4, ge=1, le=20, description="Neighbours that a picture is compared with.")
    angle_rad: Radians = Field(
        0.3, gt=0.02, le=1, description="Best angle between two views of a point [rad]."
    )
    least_score: float = Field(0.6, ge=0, lt=1, description="Lowest accepted correlation.")
    confirmed_by: int = Field(
        2, ge=1, le=20, description="Other depth maps that must show the same point."
    )
    tolerance: float = Field(0.004, gt=0, le=0.1, description="Within this share of the distance.")
    below_m: Meters = Field(
        0.2, ge=0, le=20, description="Swept below the lowest sparse points [m]."
    )
    above_m: Meters = Field(
        0.5, ge=0, le=20, description="Swept above the highest sparse points [m]."
    )
    threads: int = Field(
        2,
        ge=1,
        le=64,
        description="Pictures whose depth is measured at a time; any gives the same cloud.",
    )


class FlightSettings(Settings):
    """Settings of a flight: slanted pictures from an outer ring, steep ones from an inner ring, and
    level ones from a low ring.
    """

    cameras: int = Field(20, ge=3, le=200, description="Number of pictures of the high rings.")
    centre_m: tuple[float, float] = Field(
        (3.7, 0.0), description="Middle of the surveyed ground in the map [m]."
    )
    size_m: tuple[float, float] = Field(
        (8.4, 15.8), description="Sides of the surveyed ground along x and y [m]."
    )
    height_m: Meters = Field(
        8.0, gt=1, le=100, description="Height of the pictures above the map's origin [m]."
    )
    low_cameras: int = Field(
        12,
        ge=0,
        le=200,
        description="Pictures of a low ring, which see stones down to their feet; 0 for none.",
    )
    low_height_m: Meters = Field(
        2.5, gt=0.5, le=100, description="Height of the low ring above what is below it [m]."
    )
    view_angle_rad: Radians = Field(
        1.2, gt=0.2, lt=2.5, description="Opening angle of the camera [rad]."
    )
    rays: int = Field(110, ge=10, le=1000, description="Rays along each side of a picture.")


class GridFlightSettings(Settings):
    """Strips to and fro over the site; pictures look inwards, so that those from the outside see
    the stones' sides.
    """

    strips: int = Field(4, ge=2, le=50, description="Number of strips, along y.")
    pictures: int = Field(9, ge=2, le=100, description="Pictures of each strip.")
    centre_m: tuple[float, float] = Field(
        (3.7, 0.0), description="Middle of the surveyed ground in the map [m]."
    )
    size_m: tuple[float, float] = Field(
        (10.0, 18.0), description="Sides of the flight along x and y [m]."
    )
    aim: float = Field(
        0.5, ge=0, le=1, description="Pictures look so far out as a share of how far out they are."
    )
    height_m: Meters = Field(
        8.0, gt=1, le=100, description="Height of the flight above the map's origin [m]."
    )
    unsteadiness_m: Meters = Field(
        0.2, ge=0, le=5, description="Deviation from the plan, of place and aim [m]."
    )
    size_px: tuple[int, int] = Field(
        (1000, 750), description="Width and height of the pictures [px]."
    )
    view_angle_rad: Radians = Field(
        1.2, gt=0.2, lt=2.5, description="Opening angle across the width [rad]."
    )
    offset_m: Meters = Field(
        1.5, ge=0, le=50, description="Error of all recorded positions together [m]."
    )
    noise_m: Meters = Field(0.5, ge=0, le=20, description="Error of each, along each axis [m].")


class PointCloudFileSettings(PluginSettings):
    """The file, and the limits of an acceptable cloud."""

    path: Path = Field(description="PLY, PCD, LAS, LAZ or XYZ file; coordinates in metres.")
    voxel_m: Meters = Field(
        0.03, gt=0.005, le=0.5, description="Grid on which points are merged [m]."
    )
    min_points: int = Field(100, ge=1, description="Fewer points are no survey.")
    max_extent_m: Meters = Field(
        500.0, gt=1, description="A larger cloud is no site, or not in metres [m]."
    )

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        if not self.path.is_file():
            yield Refusal(("path",), f"there is no file '{self.path}'")


class ReconstructionSettings(Settings):
    """Size of a reconstruction's errors."""

    depth_noise_m: Meters = Field(
        0.012, ge=0, le=0.2, description="Standard deviation along the ray [m]."
    )
    point_noise_m: Meters = Field(
        0.004, ge=0, le=0.2, description="Standard deviation in all directions [m]."
    )
    warp_m: Meters = Field(
        0.02, ge=0, le=0.5, description="Largest smooth displacement along each axis [m]."
    )
    warp_wavelength_m: Meters = Field(
        10.0, ge=2, le=1000, description="Shortest wavelength of the warp [m]."
    )
    scale_error: float = Field(
        0.01, ge=0, lt=0.2, description="Largest error of the scale, as a share."
    )
    tilt_rad: Radians = Field(
        0.07, ge=0, le=1.5, description="Largest tilt of the survey's frame [rad]."
    )
    offset_m: Meters = Field(
        20.0, ge=0, le=1000, description="Largest offset of the frame along each axis [m]."
    )
    voxel_m: Meters = Field(
        0.03, gt=0.005, le=0.5, description="Grid on which points are merged [m]."
    )


class SimulatedDroneSettings(PluginSettings):
    """The flight, and the errors of the reconstruction."""

    needs: ClassVar[tuple[str, ...]] = ("robot.scene",)

    flight: FlightSettings = Field(FlightSettings(), description="Where pictures are taken.")
    reconstruction: ReconstructionSettings = Field(
        ReconstructionSettings(), description="How far it is off."
    )


class MotionSettings(Settings):
    """Features, matches, and how many pictures must find their place."""

    view_angle_rad: Radians | None = Field(
        None,
        gt=0.1,
        lt=2.8,
        description="Opening angle across the picture's width [rad]; from its tags, or guessed.",
    )
    feature_px: int = Field(
        1000, ge=200, le=8000, description="Pictures are thinned to this side for features [px]."
    )
    features: int = Field(2000, ge=200, le=20000, description="Most features of a picture.")
    neighbours: int = Field(
        8, ge=3, le=200, description="Each picture is matched with so many nearest ones."
    )
    least_registered: float = Field(
        0.7, gt=0, le=1, description="Share of the pictures that must find their place."
    )


class PhotogrammetrySettings(PluginSettings):
    """Settings of each step."""

    motion: MotionSettings = Field(MotionSettings(), description="Where pictures were taken.")
    depth: DepthSettings = Field(DepthSettings(), description="What they show.")
    voxel_m: Meters = Field(
        0.04, gt=0.005, le=0.5, description="Grid on which points are merged [m]."
    )
    fewest: int = Field(
        2, ge=1, le=100, description="Fewest points of a cell: lone ones are chance."
    )
    margin_m: Meters = Field(
        0.0, ge=-50, le=50, description="Ground kept beyond the outline of the cameras [m]."
    )
    max_scale_error: float = Field(
        0.05, gt=0, le=0.5, description="Largest standard deviation of the scale, a share."
    )


class ColmapSettings(PhotogrammetrySettings):
    """Which photographs, and how they are made into a cloud."""

    photographs: Path = Field(
        description="Folder of JPEG or PNG files from one camera, which overlap."
    )
    positions: Path | None = Field(
        None,
        description="CSV: name,x,y,z or name,lat,lon,alt; else positions.csv among them, else "
        "their GPS tags.",
    )
    work: Path | None = Field(
        None,
        description="Folder that keeps what is done until the cloud is there: a survey that was "
        "cut off goes on from it.",
    )

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        if not self.photographs.is_dir():
            yield Refusal(("photographs",), f"there is no folder '{self.photographs}'")
        if self.positions is not None and not self.positions.is_file():
            yield Refusal(("positions",), f"there is no file '{self.positions}'")


class SimulatedPhotographsSettings(PhotogrammetrySettings):
    """The flight, and how its pictures are made into a cloud."""

    needs: ClassVar[tuple[str, ...]] = ("robot.photographs",)

    flight: GridFlightSettings = Field(
        GridFlightSettings(), description="Where pictures are taken."
    )
    folder: Path | None = Field(
        None, description="Folder that keeps the pictures, for `colmap`; else none is kept."
    )

    def refusals(self, machine: Machine) -> Iterator[Refusal]:
        folder = self.folder
        if folder and folder.exists() and not (folder.is_dir() and not any(folder.iterdir())):
            told = f"'{folder}' is there already and not empty; name a new folder"
            yield Refusal(("folder",), told)
