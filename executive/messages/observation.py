"""Any measurement of a robot."""

from executive.messages.gnss import GnssFix
from executive.messages.imu import ImuSample
from executive.messages.joints import JointSample
from executive.messages.lidar import LidarScan

Observation = ImuSample | GnssFix | JointSample | LidarScan
