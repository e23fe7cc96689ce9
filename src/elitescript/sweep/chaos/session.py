"""Chaos of one plan, kept in a runner: the plain run once, then the disturbances and the properties of every run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from elitescript.records import replace
from elitescript.sweep.chaos.applying import apply
from elitescript.sweep.chaos.drawing import PLAIN_UNTIL_S, Source, draw, time_limit_s
from elitescript.sweep.chaos.ground import Ears, End, Ground, end_of, survey
from elitescript.sweep.chaos.profile import profile_of
from elitescript.sweep.chaos.properties import BuiltInProperty, Situation, built_in, failure_of
from elitescript.sweep.plans.plan import Choices, Disturbance, Failure, Plan

if TYPE_CHECKING:
    from elitescript.properties.verdicts import Verdict
    from elitescript.robot import VirtualRobot
    from elitescript.run import Run

Play = Callable[[Choices, float | None, Callable[["VirtualRobot"], None]], tuple["VirtualRobot", "Run"]]
"""Runs a program without properties: with choices, up to a time, and with a call for the robot before it begins."""


class ChaosSession:
    """Draws what goes wrong in each run of a plan, lets it happen, and knows what built-in properties need.

    A runner makes one if `plan.chaos` is not empty or a built-in property is asked for. It calls `draw` for the
    disturbances of a run; `begin` with the robot of a run before its program, which applies them; and runs it up to
    `until_s`. `property` returns the properties that are built in, and `failure` says why a run failed.

    Args:
        plan: of the sweep.
        plain: choices of the plain run, with the plain value of everything that is varied.
        robot: the arm and safety limits of every run.
        play: runs the program.
        source_of: returns the source of random numbers of a run for a name.

    Raises:
        UsageError: the profile makes no sense.
    """

    __slots__ = ("_choices", "_ground", "_others", "_plain", "_plan", "_play", "_profile", "_situation", "_source_of")

    def __init__(
        self,
        plan: Plan,
        plain: Choices,
        robot: VirtualRobot,
        play: Play,
        source_of: Callable[[int, str], Source],
    ) -> None:
        self._plan = plan
        self._plain = replace(plain, disturbances=())
        self._play = play
        self._source_of = source_of
        self._profile = profile_of(plan.chaos) if plan.chaos else None
        self._ground: Ground | None = None
        self._choices = self._plain
        self._others: tuple[str, End] | None = None
        self._situation = Situation(robot.model, robot.options.safety, lambda: self.ground.plain, self._plain_end)

    @property
    def ground(self) -> Ground:
        """What there is to disturb; the plain run is made when it is first asked for."""
        if self._ground is None:
            ears: list[Ears] = []
            until_s = PLAIN_UNTIL_S if self._plan.until_s is None else self._plan.until_s
            robot, run = self._play(self._plain, until_s, lambda robot: ears.append(Ears(robot)))
            self._ground = survey(robot, run, ears[0].heard)
        return self._ground

    def property(self, text: str) -> BuiltInProperty:
        """Return a property that is built in.

        Raises:
            UsageError: there is no such property, or it takes no margin.
        """
        return built_in(text, self._situation)

    def draw(self, run: int) -> tuple[Disturbance, ...]:
        """Return what goes wrong in a run; nothing without a profile."""
        if self._profile is None:
            return ()
        return draw(self._profile, self.ground, lambda name: self._source_of(run, name))

    def begin(self, robot: VirtualRobot, choices: Choices) -> None:
        """Let the disturbances of a run happen to its robot, and know the run that is judged next.

        Raises:
            UsageError: one makes no sense there.
        """
        apply(robot, choices.disturbances)
        self._choices = choices
        self._situation.disturbances = choices.disturbances

    def until_s(self, disturbances: Sequence[Disturbance]) -> float | None:
        """Return the limit of virtual time of a run, s."""
        if self._profile is None and not disturbances:
            return self._plan.until_s
        return time_limit_s(self.ground, disturbances, self._plan.until_s)

    def failure(self, text: str, verdict: Verdict, run: Run) -> Failure:
        """Return why the run that has begun last failed."""
        return failure_of(text, verdict, run, self._situation)

    def _plain_end(self) -> End:
        """Return the end of the run that is judged, made without its disturbances."""
        choices = replace(self._choices, disturbances=())
        key = repr((choices.seed, sorted(choices.values.items())))
        if self._others is None or self._others[0] != key:
            _, run = self._play(choices, self.until_s(()), lambda robot: None)
            self._others = key, end_of(run)
        return self._others[1]
