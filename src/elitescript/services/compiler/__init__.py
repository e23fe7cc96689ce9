"""Long programs compiled in a process of their own: it, the robot that gives them away, and the parent between both."""
