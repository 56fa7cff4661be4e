"""A machine read from data: joints, links, sensors, kinematics, and what is generated from them."""
