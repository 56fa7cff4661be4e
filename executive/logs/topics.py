"""Topics of a log: one for each kind of sensor; sensors of a kind differ by their frame."""

from pydantic import Field

from executive.config import Settings

METADATA = "executive"  # the record by which a log names the machine that it was taken on
TYPES = {
    "imu": "sensor_msgs/msg/Imu",
    "gnss": "sensor_msgs/msg/NavSatFix",
    "joints": "sensor_msgs/msg/JointState",
    "odometry": "nav_msgs/msg/Odometry",
    "points": "sensor_msgs/msg/PointCloud2",
    "tf_static": "tf2_msgs/msg/TFMessage",
}


class Topics(Settings):
    """Names of the topics; a log must have those of inertial and satellite measurements."""

    imu: str = Field("/imu/data", description=TYPES["imu"])
    gnss: str = Field("/gnss/fix", description=TYPES["gnss"])
    joints: str = Field("/joint_states", description=TYPES["joints"])
    odometry: str = Field(
        "/odometry", description=TYPES["odometry"] + ", poses of a lidar in its odometry frame"
    )
    points: str = Field("/points", description=TYPES["points"])
    tf_static: str = Field("/tf_static", description=TYPES["tf_static"])
