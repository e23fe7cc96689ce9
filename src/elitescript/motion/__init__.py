"""Planned moves: where the arm goes and when. Pure; time is an argument.

Four nouns. A *path* is geometry over a path position s, a *profile* is the time law s(t), a
*segment* is both, the *planner* turns a request into a segment or refuses it. A segment is a
function of time without memory: it may be sampled at any time and in any order. `timescale`
lays a changing speed percentage, a pause or a stop over a segment without touching it.
"""
