"""The kinds of nodes: the name of the element of each, its record, and where its fields stand.

Where real files, or files of third parties, have shown an element, its row says so in the reference of node kinds in
the documentation; the others are *assumed*.
"""

from __future__ import annotations

from typing import Final

from elitescript.program_tree import nodes
from elitescript.program_tree.cells import Expression
from elitescript.program_tree.fields import (
    Attribute,
    ChildAttribute,
    ChildExpression,
    ChildPosition,
    ChildQuantity,
    ChildText,
    ChildVariable,
    Count,
    Field,
    FieldsByKind,
    FramePose,
    NameOfObject,
    ValueWithUnit,
    flag,
)
from elitescript.program_tree.nodes import Node
from elitescript.records import record


@record
class Kind:
    """A kind of node.

    Attributes:
        element: name of its element.
        node: its record.
        fields: where its fields stand, in the order in which a new element has them.
        holds: the element that its children stand in; empty: they stand in it directly; None: it has none.
        only: names of the elements that are its children, where others stand beside them; empty: all are.
        when: the attribute, and its value, by which it differs from another kind of the same element.
        others: attributes that a new element has besides.
    """

    element: str
    node: type[Node]
    fields: tuple[Field, ...] = ()
    holds: str | None = None
    only: frozenset[str] = frozenset()
    when: tuple[str, str] = ("", "")
    others: tuple[tuple[str, str], ...] = ()


_HIGH: Final = {"HIGH": True, "LOW": False}
_SPEEDS: Final = (
    ChildQuantity("joint_speed", "jointSpeed", "angular speed"),
    ChildQuantity("joint_acceleration", "jointAcceleration", "angular acceleration"),
    ChildQuantity("speed", "cartesianSpeed", "speed"),
    ChildQuantity("acceleration", "cartesianAcceleration", "acceleration"),
)
_INPUT: Final = (ChildText("pin", "digitalInputType"), ChildText("is_high", "digitalValue", _HIGH, True))
_OF_MOVES: Final = frozenset({"WaypointNode", "DirectionNode", "ArcMotion", "PlaceHolder", "CompressNode", "Comment"})
_OF_WAYPOINTS: Final = frozenset({"UntilNode", "PlaceHolder", "CompressNode"})
_BRANCHES: Final = frozenset({"ElseIfNode", "ElseNode"})

BRANCHES: Final = _BRANCHES
"""Nodes that stand behind the children of an if, inside its element."""

KINDS: Final = (
    Kind("InitVariables", nodes.InitVariables),
    Kind("BeforeStart", nodes.BeforeStart, holds=""),
    Kind(
        "MainTask",
        nodes.MainTask,
        (
            flag("loops", "isTaskAlwaysLoops"),
            flag("has_before_start", "hasBeforeStart"),
            flag("has_init_variables", "hasInitVariables"),
        ),
        holds="",
    ),
    Kind(
        "SubTaskNode",
        nodes.SubTask,
        (
            Attribute("name", "name"),
            flag("is_hidden", "isHideSubtree"),
            flag("is_synchronized", "isSynchronized"),
            flag("is_tracking", "isTracking"),
        ),
        holds="children",
    ),
    Kind("FolderNode", nodes.Folder, (Attribute("name", "display"), flag("is_hidden", "isHideSubtree")), holds=""),
    Kind(
        "ScriptNode",
        nodes.ScriptFile,
        (
            ChildText("text", "cachedFileContents"),
            ChildAttribute("path", "scriptFile", "path", {"pathRootType": "TASK_PATH"}),
        ),
        when=("scriptType", "FILE_TYPE"),
    ),
    Kind("ScriptNode", nodes.ScriptLine, (ChildExpression("statement"),), when=("scriptType", "LINE_TYPE")),
    Kind(
        "IfNode",
        nodes.If,
        (flag("is_continuous", "checkExpressionContinuous"), ChildExpression("condition")),
        holds="children",
    ),
    Kind("ElseIfNode", nodes.ElseIf, (ChildExpression("condition"),), holds="children"),
    Kind("ElseNode", nodes.Else, holds="children"),
    Kind(
        "LoopNode",
        nodes.Loop,
        (
            Attribute(
                "kind",
                "type",
                {"LOOP_ALWAYS": "always", "LOOP_X_TIMES": "count", "LOOP_EXPRESSION": "expression"},
                "always",
            ),
            Count("count", "loopCount", absent=0),
            flag("is_checked_continuously", "isCheckConditionInSeparateThread"),
            flag("is_post_test", "isPostTestLoop"),
            ChildVariable("variable", kind="Loop"),
            ChildExpression("condition"),
        ),
        holds="children",
    ),
    Kind(
        "MoveNode",
        nodes.Move,
        (
            Attribute(
                "movement",
                "movementType",
                {"JOINT_MOVEMENT": "joint", "LINEAR_MOVEMENT": "linear", "PROCESS_MOVEMENT": "process"},
                "joint",
            ),
            Attribute("has_joint_positions", "positionType", {"CARTESIAN_POSE": False, "JOINT_ANGLES": True}, False),
            ChildText("frame", "frameReference", absent="Ctrl_base_frame"),
            *_SPEEDS,
            ChildQuantity("radius", "inheritedProcessMoveTransitionRadius", "length"),
            ChildText("tcp", "tcpToolNameReference", absent=None),
        ),
        holds="",
        only=_OF_MOVES,
    ),
    Kind(
        "WaypointNode",
        nodes.Waypoint,
        (
            Attribute("name", "name"),
            Attribute(
                "position",
                "positionNodeType",
                {"FIXED_POSITION": "fixed", "VARIABLE_POSITION": "variable", "RELATIVE_POSITION": "relative"},
                "fixed",
            ),
            flag("has_own_radius", "customTransitionRadius"),
            Attribute(
                "motion_by",
                "advancedPositionOptionType",
                {"INHERITED_PARAMETERS": "move", "SPEED_AND_ACCELERATION": "speed", "TIME": "time"},
                "move",
            ),
            ChildVariable("variable", "is_global"),
            ChildQuantity("radius", "transitionRadius", "length"),
            ChildPosition("target", "internalPosition"),
            ChildPosition("start", "fromPosition"),
            *_SPEEDS,
            ChildQuantity("duration", "nextMotionTime", "time"),
            FramePose("frame_pose"),
        ),
        holds="",
        only=_OF_WAYPOINTS,
        others=(("kinematicFlag", "-1"),),
    ),
    Kind(
        "ArcMotion",
        nodes.Arc,
        (Attribute("is_orientation_free", "orientationMode", {"UNCONSTRAINED": True, "FIXED": False}, True),),
        holds="",
        only=frozenset({"WaypointNode", "CompressNode"}),
    ),
    Kind(
        "DirectionNode",
        nodes.Direction,
        (
            Attribute("has_own_frame", "useSharedFrame", {"true": False, "false": True}, False),
            flag("is_axis", "useDirection", absent=True),
            Attribute("axis", "selectedDirection", absent="ZPositive"),
            Attribute("has_own_motion", "useSharedParams", {"true": False, "false": True}, False),
            ChildExpression("vector"),
            ChildText("frame", "frameReference"),
            ChildQuantity("speed", "cartesianSpeed", "speed"),
            ChildQuantity("acceleration", "cartesianAcceleration", "acceleration"),
        ),
        holds="children",
    ),
    Kind(
        "UntilNode",
        nodes.Until,
        (
            Attribute(
                "kind",
                "type",
                {
                    "EXPRESSION": "expression",
                    "IO": "input",
                    "DISTANCE": "distance",
                    "TOOL_CONTACT": "contact",
                    "REACHED_WAYPOINT": "waypoint",
                },
                "expression",
            ),
            FieldsByKind(
                "type",
                {
                    "EXPRESSION": (ChildExpression("condition"),),
                    "IO": _INPUT,
                    "DISTANCE": (ChildQuantity("distance", "distance", "length"),),
                    "TOOL_CONTACT": (ChildQuantity("force", "force", "force"),),
                },
                {"condition": Expression(), "pin": "", "is_high": True, "distance": None, "force": None},
            ),
            ChildText(
                "has_own_deceleration", "expressionDecelerationType", {"INHERITED": False, "CUSTOM": True}, False
            ),
            ChildQuantity("joint_deceleration", "jointDecelerationValue", "angular acceleration"),
            ChildQuantity("deceleration", "cartesianDeceleration", "acceleration"),
        ),
        holds="children",
    ),
    Kind(
        "WaitNode",
        nodes.Wait,
        (
            Attribute(
                "kind",
                "type",
                {"WAIT_TIME": "time", "WAIT_DIGITAL_INPUT": "input", "EXPRESSION": "expression"},
                "time",
            ),
            flag("has_timeout", "timeoutEnable"),
            FieldsByKind(
                "type",
                {
                    "WAIT_TIME": (ChildQuantity("duration", "waitTime", "time"),),
                    "WAIT_DIGITAL_INPUT": _INPUT,
                    "EXPRESSION": (ChildExpression("condition"),),
                },
                {"duration": None, "pin": "", "is_high": True, "condition": Expression()},
            ),
            ChildQuantity("timeout", "timeout", "time"),
        ),
    ),
    Kind(
        "SetNode",
        nodes.Set,
        (
            Attribute(
                "kind",
                "type",
                {"DIGITAL_OUTPUT": "digital", "ANALOG_OUTPUT": "analog", "EXPRESSION_OUTPUT": "expression"},
                "none",
            ),
            flag("sets_tcp", "tcpSettingEnabled"),
            FieldsByKind(
                "type",
                {
                    "DIGITAL_OUTPUT": (
                        ChildText("pin", "digitalOutputPinName"),
                        ChildText("is_high", "digitalOutputPinValue", _HIGH, True),
                    ),
                    "ANALOG_OUTPUT": (ChildText("pin", "analogOutputPinName"), ValueWithUnit("analogOutputPinValue")),
                    "EXPRESSION_OUTPUT": (ChildText("pin", "expressionOutputPinName"), ChildExpression("expression")),
                },
                {"pin": "", "is_high": True, "value": None, "unit": "", "expression": Expression()},
            ),
        ),
    ),
    Kind(
        "AssignmentNode",
        nodes.Assignment,
        (flag("is_copied", "deepCopy"), ChildVariable("variable", "is_global"), ChildExpression("value")),
        others=(("valueSourceType", "EXPRESSION"),),
    ),
    Kind("HaltNode", nodes.Halt),
    Kind("SwitchNode", nodes.Switch, (ChildExpression("value"),), holds="children"),
    Kind("CaseNode", nodes.Case, (Attribute("name", "caseName"),), holds=""),
    Kind(
        "PopupNode",
        nodes.Popup,
        (
            Attribute("kind", "dialogType", {"INFO": "info", "WARNING": "warning", "ERROR": "error"}, "info"),
            Attribute("is_variable", "contentType", {"TEXT": False, "VARIABLE": True}, False),
            Attribute("message", "message"),
            flag("is_blocking", "blockWhenPopup"),
        ),
    ),
    Kind(
        "TimerNode",
        nodes.Timer,
        (
            Attribute("action", "action", {"RESET": "reset", "START": "start", "STOP": "stop"}, "reset"),
            ChildVariable("variable", element="variable"),
        ),
    ),
    Kind("Comment", nodes.Comment, (Attribute("text", "comment"),)),
    Kind("CallSubTaskNode", nodes.CallSubTask, (NameOfObject("name", "subTask"),)),
    Kind(
        "ThreadNode", nodes.Thread, (Attribute("name", "name"), flag("loops", "isLoop", absent=True)), holds="children"
    ),
    Kind("EventNode", nodes.Event, (Attribute("name", "name"), ChildExpression("condition")), holds="children"),
    Kind("PlaceHolder", nodes.Placeholder),
    Kind(
        "TaskExtensionNode",
        nodes.Extension,
        (
            Attribute("name", "name"),
            Attribute("plugin", "OwnerID"),
            Attribute("version", "Version"),
            Attribute("vendor", "Vendor"),
        ),
        holds="children",
    ),
)
"""All kinds; a new node has the attributes and elements in this order."""

BY_ELEMENT: Final[dict[str, tuple[Kind, ...]]] = {
    kind.element: tuple(row for row in KINDS if row.element == kind.element) for kind in KINDS
}
BY_NODE: Final = {kind.node: kind for kind in KINDS}
