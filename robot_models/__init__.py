"""Machines: one folder each, robot.yaml the single source; what is generated from it; its kinematics."""
