"""Geometry of the arm: rotations, rigid transforms, poses, kinematics and inverse dynamics.

Pure functions of floats, in metres and radians. Rotations and transforms are flat tuples of
floats and the formulas are written out, because the motion planner calls them thousands of
times a second.
"""
