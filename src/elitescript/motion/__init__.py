"""Planned moves: geometry and time. Pure; time is an argument.

A *path* is geometry over a path position s, a *profile* is the time law s(t), a *segment* is both, the *planner* turns
a request into a segment or refuses it. A segment is a function of time without memory: it may be sampled at any time
and in any order. `timescale` applies a changing speed percentage, a pause or a stop to a segment without changing it.
"""
