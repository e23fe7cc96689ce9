"""How fields of nodes stand in elements: each is read and written by one object, so that reading inverts writing."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, Final, Protocol

from elitescript.program_tree.cells import (
    SIGNS,
    UNIT_CLASS,
    UNITS,
    UNTAUGHT,
    Cell,
    Expression,
    PinCell,
    Pose,
    Quantity,
    TextCell,
    UnknownCell,
    VariableCell,
    java_text,
    number_text,
    quantity,
    six,
)
from elitescript.program_tree.nodes import Position
from elitescript.program_tree.xml_text import Element, Shared, made, with_elements


class Objects:
    """The variables and sub-tasks of a document, by what they are and their names; new ones are made when asked for."""

    __slots__ = ("by_name",)

    def __init__(self, by_name: dict[tuple[str, str], Shared] | None = None) -> None:
        self.by_name = by_name if by_name is not None else {}

    def held(self, element: Element) -> Element:
        """Return the element that holds the object of an element: itself, if it refers to none."""
        shared = element.shared
        if shared is None or shared.holder is None or "reference" not in element.attributes:
            return element
        return shared.holder

    def variable(self, name: str) -> Shared:
        """Return a variable of tasks by its name."""
        return self.by_name.setdefault(("variable", name), Shared())

    def sub_task(self, name: str) -> Shared | None:
        """Return a sub-task by its name; None: there is none."""
        return self.by_name.get(("sub-task", name))


class Field(Protocol):
    """One or more fields of a record, and where they stand."""

    @property
    def names(self) -> tuple[str, ...]:
        """The fields of the record."""

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        """Return the values of the fields."""

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        """Return the element with these values; `indent` is that of its first tag."""


class Named:
    """A text that stands for a value; one that the table does not have is the value itself, to be refused by name.

    Args:
        name: the field of the record.
        place: the name of the attribute or element that holds the text.
        values: the value of each text; None: the text is the value.
        absent: the value where there is none.
    """

    __slots__ = ("absent", "names", "place", "texts", "values")

    def __init__(self, name: str, place: str, values: Mapping[str, Any] | None = None, absent: Any = "") -> None:
        self.names = (name,)
        self.place = place
        self.values = values
        self.texts = {value: text for text, value in reversed(list((values or {}).items()))}
        self.absent = absent

    def value(self, text: str) -> Any:
        """Return what a text stands for."""
        return text if self.values is None else self.values.get(text.strip(), text)

    def text(self, value: Any) -> str | None:
        """Return the text of a value; None: it is left out."""
        found = value if self.values is None else self.texts.get(value, value)
        return None if found is None else str(found)


class Attribute(Named):
    """An attribute."""

    __slots__ = ()

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        text = element.attributes.get(self.place)
        return (self.absent if text is None else self.value(text),)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        return element.with_attribute(self.place, self.text(values[0]))


BOOLEANS: Final = {"true": True, "false": False}


def flag(name: str, attribute: str, *, absent: bool = False) -> Attribute:
    """Return an attribute that is `true` or `false`."""
    return Attribute(name, attribute, BOOLEANS, absent)


class Count(Attribute):
    """An attribute that is a whole number."""

    __slots__ = ()

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        text = element.attributes.get(self.place, "")
        return (int(text) if re.fullmatch(r"-?[0-9]{1,9}", text) else text or self.absent,)


class ChildText(Named):
    """The text of an element, or its attribute `referenceName`."""

    __slots__ = ()

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        child = element.child(self.place)
        if child is None:
            return (self.absent,)
        child = objects.held(child)
        return (self.value(child.text if child.content else child.attributes.get("referenceName", "")),)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        text = self.text(values[0])
        if text is None:
            return _without(element, self.place)
        child = element.child(self.place)
        if child is not None and "referenceName" in child.attributes and not child.content:
            return _with(element, child.with_attribute("referenceName", text), indent)
        return _with(element, (child or made(self.place)).with_text(text), indent)


class ChildQuantity:
    """An element with a number and its unit."""

    __slots__ = ("child", "kind", "names")

    def __init__(self, name: str, child: str, kind: str) -> None:
        self.names = (name,)
        self.child = child
        self.kind = kind

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        child = element.child(self.child)
        return (None if child is None else quantity_of(objects.held(child)),)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        if values[0] is None:
            return _without(element, self.child)
        child = element.child(self.child)
        inner = f"{indent}  "
        if child is None or child.attributes.get("reference") is not None:
            child = quantity_element(self.child, values[0], self.kind, inner)
        else:
            child = with_quantity(child, values[0], self.kind, inner)
        return _with(element, child, indent)


def quantity_of(element: Element) -> Quantity | None:
    """Return the number of an element in SI units: `valueInSi`, else `value` with `unit`, else its text."""
    in_si = element.child("valueInSi")
    if in_si is not None:
        return quantity(in_si.text)
    value = element.attributes.get("value")
    return quantity(value, element.attributes.get("unit", "")) if value is not None else quantity(element.text)


def quantity_element(name: str, value: float, kind: str, indent: str) -> Element:
    """Return a new element with a number in the unit of SI."""
    unit, of_class = UNITS[kind]
    text = number_text(value)
    parts = [made("valueInSi", None, text), made("siUnit", {"class": f"{UNIT_CLASS}{of_class}"}, unit)]
    return with_elements(made(name, {"value": text, "unit": unit}), parts, indent)


def with_quantity(element: Element, value: float, kind: str, indent: str) -> Element:
    """Return an element with another number, in the unit of SI."""
    text, (unit, _) = number_text(value), UNITS[kind]
    in_si = element.child("valueInSi")
    if in_si is None and "value" not in element.attributes:
        return quantity_element(element.name, value, kind, indent)
    if "value" in element.attributes:
        element = element.with_attribute("value", text).with_attribute("unit", unit)
    return element if in_si is None else _with(element, in_si.with_text(text), indent)


class ChildExpression:
    """An element `Expression` with cells."""

    __slots__ = ("names",)

    def __init__(self, name: str) -> None:
        self.names = (name,)

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        child = element.child("Expression")
        if child is None:
            return (Expression(),)
        return (Expression(tuple(_cell(cell, objects) for cell in objects.held(child).elements)),)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        inner = f"{indent}  "
        cells = [_cell_element(cell, objects) for cell in values[0].cells]
        child = element.child("Expression") or made("Expression")
        return _with(element, with_elements(made("Expression", dict(child.attributes)), cells, inner), indent)


def _cell(element: Element, objects: Objects) -> Cell:
    kind, given = element.name, element.attributes
    if kind == "ExpressionCharCell" and "char" in given:
        sign = given["char"]
        return TextCell(SIGNS[sign], sign) if sign in SIGNS else TextCell(sign)
    if kind == "ExpressionTokenCell" and "scriptCode" in given:
        return TextCell(given["scriptCode"], given.get("token", ""))
    if kind == "ExpressionVariableCell":
        for child in element.elements:
            name, is_global = variable_of(child, objects)
            if name:
                return VariableCell(name, is_global)
    if kind == "ExpressionPinCell":
        for child in element.elements:
            if "referenceName" in child.attributes:
                return PinCell(child.attributes["referenceName"])
    for name in ("scriptCode", "name", "frameName"):
        if name in given:
            return TextCell(given[name], given.get("token", ""))
    return UnknownCell(kind)


def _cell_element(cell: Cell, objects: Objects) -> Element:
    if isinstance(cell, TextCell):
        if len(cell.script) == 1 or cell.shown in SIGNS:
            return made("ExpressionCharCell", {"char": cell.shown if cell.shown in SIGNS else cell.script})
        return made("ExpressionTokenCell", {"token": cell.shown or cell.script, "scriptCode": cell.script})
    if isinstance(cell, VariableCell):
        inside = variable_element(cell.name, is_global=cell.is_global, objects=objects)
        return made("ExpressionVariableCell").with_content((inside,))
    if isinstance(cell, PinCell):
        return made("ExpressionPinCell").with_content((made("pin", {"referenceName": cell.pin}),))
    return made(cell.kind)


def variable_of(element: Element, objects: Objects) -> tuple[str, bool]:
    """Return the name of the variable that an element stands for and whether it is global; no name: it is none."""
    if element.name == "ConfigurationEntityReference":
        return element.attributes.get("frameName", ""), True
    if element.name in ("TaskVariable", "variable"):
        return objects.held(element).attributes.get("name", ""), False
    return "", False


def variable_element(name: str, *, is_global: bool, objects: Objects, kind: str = "Default") -> Element:
    """Return a new element for a variable."""
    if is_global:
        return made("ConfigurationEntityReference", {"frameName": name, "type": "Configuration_Variable"})
    element = made(
        "TaskVariable",
        {"name": name, "type": kind, "prefersPersistentValue": "false", "favorite": "false", "describe": ""},
    )
    element.shared = objects.variable(name)
    if element.shared.holder is None:
        element.shared.holder = element
    return element


class ChildVariable:
    """An element that stands for a variable: its name, and whether it is one of the configuration."""

    __slots__ = ("element", "kind", "names")

    def __init__(self, name: str, is_global: str = "", kind: str = "Default", element: str = "TaskVariable") -> None:
        self.names = (name, is_global) if is_global else (name,)
        self.kind = kind
        self.element = element

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        for child in element.elements:
            name, is_global = variable_of(child, objects)
            if name:
                return (name, is_global)[: len(self.names)]
        return ("", False)[: len(self.names)]

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        is_global = len(values) > 1 and values[1]
        old = next((child for child in element.elements if variable_of(child, objects)[0]), None)
        if not values[0]:
            return element if old is None else element.without_child(element.elements.index(old))
        new = variable_element(values[0], is_global=is_global, objects=objects, kind=self.kind)
        if not is_global and self.element != "TaskVariable":
            new = Element(self.element, f"<{self.element}{new.head[len('<TaskVariable') :]}", shared=new.shared)
        if old is None:
            return element.with_child(0, new, f"{indent}  ")
        return element.with_replaced(element.elements.index(old), new)


_POSES: Final = ("toolPose", "flangePose")
_AXES: Final = ("X", "Y", "Z", "RX", "RY", "RZ")


class ChildPosition:
    """An element with joint positions and poses; its lengths are millimetres."""

    __slots__ = ("child", "names")

    def __init__(self, name: str, child: str) -> None:
        self.names = (name,)
        self.child = child

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        child = element.child(self.child)
        if child is None:
            return (Position(),)
        child = objects.held(child)
        joints = child.child("jointPositions")
        read = six(joints.attributes.get("joints", "")) if joints is not None else None
        tool = child.child("toolPose")
        return (Position(UNTAUGHT if read is None else read, None if tool is None else _stored_pose(tool)),)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        position = values[0]
        inner = f"{indent}  "
        child = element.child(self.child) or made(self.child)
        joints = (child.child("jointPositions") or made("jointPositions")).with_attribute(
            "joints", ", ".join(number_text(value) for value in position.joints)
        )
        child = _with(child, joints, inner)
        pose = position.pose or (0.0,) * 6
        numbers = [
            java_text(round(value * 1000.0, 9)) if axis < 3 else number_text(value) for axis, value in enumerate(pose)
        ]
        tool = child.child("toolPose") or made("toolPose")
        for axis, number in zip(_AXES, numbers, strict=True):
            tool = tool.with_attribute(axis, number)
        return _with(element, _with(child, tool, inner), indent)


def _stored_pose(element: Element) -> Pose | None:
    """Return a pose with lengths in m; None: six zeros or NaN, which real files have where none is stored."""
    numbers = [quantity(element.attributes.get(axis, "")) for axis in _AXES]
    if any(number is None or number != number for number in numbers) or not any(numbers):
        return None
    return tuple(
        _from_millimetres(number) if axis < 3 else number  # type: ignore[arg-type]
        for axis, number in enumerate(numbers)
    )  # type: ignore[return-value]


def _from_millimetres(number: Quantity) -> Quantity:
    """Return a length in m with the digits that it has in mm: 485.623 is 0.485623, and not one bit less."""
    text = number.text.lower()
    return Quantity(number / 1000.0 if "e" in text else float(f"{text}e-3"))


class FramePose:
    """An element `Pose key="baseToFrame"`, which is read and kept."""

    __slots__ = ("names",)

    def __init__(self, name: str) -> None:
        self.names = (name,)

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        for child in element.elements:
            if child.name == "Pose" and child.attributes.get("key") == "baseToFrame":
                values = {
                    number.attributes.get("key", ""): quantity(
                        number.attributes.get("value", ""), number.attributes.get("unit", "")
                    )
                    for part in objects.held(child).elements
                    for number in part.elements
                }
                numbers = [values.get(axis) for axis in _AXES]
                return (None if None in numbers else tuple(numbers),)
        return (None,)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        old = next(
            (
                child
                for child in element.elements
                if child.name == "Pose" and child.attributes.get("key") == "baseToFrame"
            ),
            None,
        )
        if values[0] is None:
            return element if old is None else element.without_child(element.elements.index(old))
        numbers = dict(zip(_AXES, values[0], strict=True))
        inner = f"{indent}  "

        def part(name: str, key: str, number: str, axes: tuple[str, ...], unit: str) -> Element:
            rows = [made(number, {"key": axis, "value": number_text(numbers[axis]), "unit": unit}) for axis in axes]
            return with_elements(made(name, {"key": key}), rows, f"{inner}  ")

        new = with_elements(
            made("Pose", {"key": "baseToFrame"}),
            [
                part("Position", "posePosition", "Length", _AXES[:3], "M"),
                part("Rotation", "poseRotation", "Angle", _AXES[3:], "RAD"),
            ],
            inner,
        )
        if old is None:
            return element.with_child(len(element.elements), new, inner)
        return element.with_replaced(element.elements.index(old), new)


class ChildAttribute:
    """An attribute of an element in it."""

    __slots__ = ("attribute", "child", "fixed", "names")

    def __init__(self, name: str, child: str, attribute: str, fixed: Mapping[str, str]) -> None:
        self.names = (name,)
        self.child = child
        self.attribute = attribute
        self.fixed = dict(fixed)

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        child = element.child(self.child)
        return ("" if child is None else objects.held(child).attributes.get(self.attribute, ""),)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        child = element.child(self.child) or made(self.child, self.fixed)
        return _with(element, child.with_attribute(self.attribute, values[0]), indent)


class ValueWithUnit:
    """A number in A or V, with its unit."""

    __slots__ = ("child", "names")

    def __init__(self, child: str) -> None:
        self.names = ("value", "unit")
        self.child = child

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        child = element.child(self.child)
        if child is None:
            return (None, "")
        child = objects.held(child)
        unit = (child.attributes.get("unit") or (child.child("siUnit") or made("")).text.strip()).upper()
        return (quantity_of(child), "V" if "V" in unit else "A" if "A" in unit else unit)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        kind = "voltage" if values[1] == "V" else "current"
        return ChildQuantity("value", self.child, kind).write(element, values[:1], objects, indent)


class FieldsByKind:
    """Fields that stand in other elements for each text of an attribute."""

    __slots__ = ("absent", "attribute", "fields", "names")

    def __init__(self, attribute: str, fields: Mapping[str, tuple[Field, ...]], absent: Mapping[str, Any]) -> None:
        self.attribute = attribute
        self.fields = fields
        self.absent = absent
        self.names = tuple(absent)

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        values = dict(self.absent)
        for field in self.fields.get(element.attributes.get(self.attribute, ""), ()):
            values.update(zip(field.names, field.read(element, objects), strict=True))
        return tuple(values.values())

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        given = dict(zip(self.names, values, strict=True))
        for field in self.fields.get(element.attributes.get(self.attribute, ""), ()):
            element = field.write(element, tuple(given[name] for name in field.names), objects, indent)
        return element


class NameOfObject:
    """The name of the object that an element in it holds or refers to."""

    __slots__ = ("child", "names")

    def __init__(self, name: str, child: str) -> None:
        self.names = (name,)
        self.child = child

    def read(self, element: Element, objects: Objects) -> tuple[Any, ...]:
        child = element.child(self.child)
        return ("" if child is None else objects.held(child).attributes.get("name", ""),)

    def write(self, element: Element, values: tuple[Any, ...], objects: Objects, indent: str) -> Element:
        child = made(self.child)
        shared = objects.sub_task(values[0])
        if shared is not None:
            child = Element(self.child, f'<{self.child} reference=""/>', shared=shared)
        else:
            child = made(self.child, {"name": values[0]})
        return _with(element, child, indent)


def _with(element: Element, child: Element, indent: str) -> Element:
    """Return an element with a child in place of the one of its name, or as its last one."""
    for index, old in enumerate(element.elements):
        if old.name == child.name:
            return element.with_replaced(index, child)
    return element.with_child(len(element.elements), child, f"{indent}  ")


def _without(element: Element, name: str) -> Element:
    for index, old in enumerate(element.elements):
        if old.name == name:
            return element.without_child(index)
    return element
