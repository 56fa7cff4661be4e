"""Settings of the grasping plugins, apart from them: reading a mission imports no algorithm."""

from pydantic import Field

from executive.config import KilogramsPerCubicMeter, Meters, Radians
from executive.interfaces.declaration import PluginSettings


class SamplingSettings(PluginSettings):
    """Density, sampling and clearance, for a gripper that opens about two metres."""

    scale: float = Field(
        1.0,
        gt=0,
        le=10,
        description="Factor on all lengths of this plugin, for other sizes of gripper and stones.",
    )
    samples: int = Field(
        80, ge=1, le=5000, description="Number of surface points for which approaches are made."
    )
    turns_about_y: int = Field(
        5, ge=1, le=36, description="Number of rotations about the y axis of a frame, over ±60°."
    )
    turns_about_z: int = Field(
        8, ge=1, le=36, description="Number of rotations about the z axis of a frame, over ±80°."
    )
    downward_yaws: int = Field(
        36, ge=0, le=360, description="Number of yaws of approaches straight down; 0 for none."
    )
    spacing_m: Meters = Field(0.04, gt=0, description="Point spacing of the planning cloud [m].")
    frame_radius_m: Meters = Field(
        0.25, gt=0, description="Radius of the ball of a local frame (Eq. 4) [m]."
    )
    max_tilt_rad: Radians = Field(
        0.7, gt=0, le=1.6, description="Largest angle of an approach off the vertical [rad]."
    )
    stone_clearance_m: Meters = Field(
        0.04, ge=0, description="Clearance between palm or open jaws and the stone [m]."
    )
    other_clearance_m: Meters = Field(
        0.02, ge=0, description="Clearance between the gripper and anything else [m]."
    )
    tips_below_centre_m: Meters = Field(
        0.02, ge=-1, le=1, description="How far the tips close below the stone's centre [m]."
    )
    into_soil_m: Meters | None = Field(
        None,
        ge=0,
        le=0.5,
        description="How far the tips may go below the ground beside the stone [m]: by default as "
        "far as the gripper digs (`digs_m` of robot.yaml); 0 where tips below a stone are in the "
        "way where it is set down.",
    )
    also_above_ground: bool = Field(
        False,
        description="Whether as many grasps whose tips stay above the ground are returned besides: "
        "tips below the foot of a stone meet the stones on which it is set down.",
    )
    density: KilogramsPerCubicMeter = Field(2700.0, gt=0, description="Density of a stone [kg/m³].")
