"""Motions without a planned end: joint and tool speeds, streams of joint targets."""
