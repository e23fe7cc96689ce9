"""What goes wrong at random: drawn from the world that is there, applied to a robot in virtual time.

`profile` says what is drawn, `ground` finds out in a plain run what there is to disturb, `drawing` draws the
disturbances of a run, `applying` lets them happen, `properties` has the properties that need no writing.
"""
