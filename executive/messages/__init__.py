"""Frozen values, in the order in which data flows; a file imports only earlier ones.

imu, gnss, joints, lidar → base_state → cloud → segment → alignment → stone → grasp → placement →
trajectory → verdict
"""
