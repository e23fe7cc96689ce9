"""Error codes with their severities against a table written by hand: scripts, editors and pipelines go by them."""

from __future__ import annotations

import pytest

from elitescript.errors import CODES
from tests.tables import rows

# What a code is about, and its first and last number. A code that is given away once never means anything else.
FAMILIES = """
E001-E099   error     what is no text of a program
E101-E199   error     what keeps a program from starting
W201-W299   warning   what suspects a mistake
N201-N299   note      what a sound program may have too
E301-E399   error     what contradicts the catalogue of commands
R100-R199   error     alarms while a program runs
"""

KNOWN = """
E001   error     Python syntax
E002   error     the text is not UTF-8
E101   error     `end` that closes nothing
E102   error     program unit without its closing `end`
E103   error     clause after the `end` of its statement
E104   error     empty block
E105   error     `sec` inside a block
E106   error     print statement of Python 2
E107   error     program parameter without a default
E108   error     `global` with an assignment
E109   error     `global` after the name was used
E110   error     long-integer suffix of Python 2
E111   error     `<>` or backquotes of Python 2
E112   error     statement form of Python 2
E113   error     operator of C
E114   error     statement of URScript
E115   error     name or attribute that scripts may not use
W201   warning   unknown name
W202   warning   assignment that hides a global; `global` missing?
W203   warning   name of a robot command used for something else
W204   warning   loop that never waits
W205   warning   call that a secondary program may not make
W206   warning   `global` that is never assigned
W207   warning   code that is never reached
W208   warning   use of the program's own name
W209   warning   name of Python 2
W210   warning   escape sequence that Python does not have
W211   warning   pose literal of URScript
W212   warning   syntax newer than the robot's Python
W213   warning   module that is not available
W214   warning   text in which nothing runs
W215   warning   call without its parentheses
W216   warning   block without the `end` that others have
W217   warning   function that is defined twice
W218   warning   statement that does nothing
W219   warning   result that is not used
W220   warning   `return` that is missing on one path
W221   warning   reading that a secondary program does not wait for
W222   warning   text in GBK that is UTF-8 by chance
W223   warning   variable that nothing reads, beside one of nearly the same name
W224   warning   list that stands in several places and is changed
W225   warning   list that is changed in the loop that goes through it
W276   warning   text with places that nothing fills
W277   warning   result of a call that gives none
W278   warning   call that fails with these values
W279   warning   `^` where a power is meant
W238   warning   lock that stays acquired
W239   warning   number of another quantity
W240   warning   comparison that is never, or always, true
W241   warning   condition that is always true, or not what it seems
W242   warning   measured values compared exactly
W243   warning   lists joined where numbers were meant
W244   warning   time that looks like milliseconds
W245   warning   call of a value that is no function
W246   warning   channel that nothing opens
W247   warning   another server under the name of an open channel
W248   warning   line end as the mark in front of a text
W249   warning   MODBUS signal that cannot be used like this
W251   warning   MODBUS signal added in the loop that reads it
W252   warning   address that no device has
W253   warning   serial port that is not set up for the command
W254   warning   thread handle used as a value
W255   warning   tool pin that is set and is no output
W256   warning   variable that has no value yet
W257   warning   variable that one branch alone gives a value
W258   warning   variable that hides that of the enclosing program
W259   warning   waiting loop that nothing ends
W261   warning   loop that only swallows refusals
W262   warning   reading that may have failed and is used unasked
W263   warning   list that is changed under its other name
W264   warning   operation that Python does not have
W265   warning   element that a list does not have
W266   warning   arguments that have changed places
W267   warning   per cent where a fraction is meant
W268   warning   number that the receiver cannot hold
W269   warning   call that never ends, in place of a function for a thread
N221   note      encoder that is tracked and not set up
N222   note      thread that the end of the program ends
N223   note      output behind a blended move
N224   note      path that stops at each of its points
N226   note      sleep that is very long
N228   note      function that nothing calls
E301   error     unknown command
E302   error     command of a newer firmware
E303   error     wrong number or names of arguments
E304   error     argument of the wrong type
E305   error     argument outside its range
R100   error     uncaught Python exception
R101   error     argument of the wrong type
R102   error     argument outside its range
R103   error     wrong number or names of arguments
R104   error     invalid value
R105   error     command of a newer firmware
R106   error     command that is not simulated
R110   error     target outside the joint limits
R111   error     target out of reach
R112   error     path through a singularity
R113   error     arc without a plane
R114   error     two motions at once
R115   error     the arm is not ready to move
R116   error     the arm is not where the points begin
R117   error     points too far apart
R118   error     motion that a joint cannot follow
R120   error     call that a secondary program may not make
R121   error     too many threads
R122   error     I/O point in the wrong mode
R123   error     access that scripts do not have
R130   error     nothing can ever happen again
R131   error     the thread cannot be stopped
R132   error     the controller had to be restarted
R133   error     remote procedure call that failed
R134   error     MODBUS signal that does not work
R135   error     calls that hold up the robot
R140   error     protective stop
R141   error     emergency stop
R142   error     violation or fault of the safety system
"""


@pytest.mark.parametrize(("code", "severity", "title"), rows(KNOWN))
def test_code(code: str, severity: str, title: str) -> None:
    row = CODES[code]
    assert (row.code, row.severity, row.title) == (code, severity, title)


@pytest.mark.parametrize("code", CODES)
def test_every_code_belongs_to_a_family_with_its_severity(code: str) -> None:
    found = [severity for span, severity, _ in rows(FAMILIES) if span[:4] <= code <= span[-4:]]
    assert found == [CODES[code].severity]
    assert CODES[code].code == code
