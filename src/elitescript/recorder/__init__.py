"""Recordings of controllers: what their ports show, written down without touching the robot."""
