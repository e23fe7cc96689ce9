"""What moves the arm: planned moves in sequence, streams of targets, conveyors, path offsets."""
