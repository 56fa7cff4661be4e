"""Whether the arm reaches a grasp, and whether the open gripper gets there without a collision."""
