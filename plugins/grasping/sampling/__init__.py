"""From a stone and its surroundings to a pool of grasps that hold it and touch nothing else."""
