//! Codes of resolving: modules, names, units.

eng_grammar::codes! {
    RESOLVING:

    NO_MODULE = "E0201", "a module or file that is used does not exist",
        "`use` names a module of the library (`std.joints`) or a file beside the model: `use oils.House` takes House from `oils.eng`.",
        "use std.joins.Revolute",
        "use std.joints.Revolute";
    USE_CIRCLE = "E0202", "modules use each other in a circle",
        "Two files use names of each other. Move the common items into a third file.",
        "", "";
    NOT_IN_MODULE = "E0203", "a module has no item of this name",
        "The module exists, but it has no item with this name. Names are case-sensitive.",
        "use std.joints.Revolut",
        "use std.joints.Revolute";
    DEFINED_TWICE = "E0204", "a name is defined twice",
        "A name has one meaning in its block, and so has an attribute. Rename one, or remove it.",
        "param bore: Length = 86 mm\nlet bore = 87 mm",
        "param bore: Length = 86 mm\nlet larger_bore = 87 mm";
    UNKNOWN_NAME = "E0205", "a name is not known",
        "Names come from the block, the class or file around it, and from `use`. A unit is no name: it follows a number.",
        "let area = pi/4*boer^2",
        "let area = pi/4*bore^2";
    UNKNOWN_UNIT = "E0206", "a unit is not known",
        "The library defines the units. They are case-sensitive and joined by `*`, `/` and `^` without spaces. A value may follow a unit as a factor: `2 N*length`. This word is neither a unit nor a value.",
        "param torque: Torque = 20 Ncm",
        "param torque: Torque = 20 N*cm";
    UNKNOWN_TYPE = "E0207", "a type or dimension is not known",
        "A type is a dimension (`Length`, `Force/Area`), a vector, list, record, interface or class. A unit is no type.",
        "param bore: mm = 86 mm",
        "param bore: Length = 86 mm";
    UNIT_CIRCLE = "E0208", "dimensions or units are defined by each other",
        "Every dimension follows from base dimensions, and every unit from a unit without a right side.",
        "unit hand = 1/3 foot\nunit foot = 3 hand",
        "unit foot = 0.3048 m\nunit hand = 1/3 foot";
    BAD_UNIT = "E0209", "the definition of a dimension or unit does not make sense",
        "A unit is a number in known units. It is not zero and has the stated dimension. A point belongs to one base dimension.",
        "unit knot: Velocity = 1852 m",
        "unit knot: Velocity = 1852/3600 m/s";
    AMBIGUOUS_USE = "E0210", "two modules bring the same name",
        "The name would have two meanings. Take it from one of the modules by its name.",
        "use oils.*\nuse greases.*",
        "use oils.House\nuse greases.Lithium";
    NO_MEMBER = "E0211", "a thing has no member of this name",
        "After a dot follows a marker of a body, an output or value of an element, a field of a record, or a member that every marker has.",
        "start pin.angel = 30 deg",
        "start pin.angle = 30 deg";
    RETURN_ALONE = "E0212", "a line end is a carriage return alone",
        "Lines end with a line feed (LF), with or without a carriage return before it (CR LF). A carriage return alone, as old systems wrote it, would make one line of the whole text. Save the text with one of the two line ends.",
        "", "";
    UNUSED_USE = "W0201", "a name is taken from a module but not used",
        "The model runs. Remove the name, or use it: perhaps another name was used in its place.",
        "use std.joints.{Revolute, Fixed}",
        "use std.joints.Revolute";
    EMPTY_TEXT = "W0202", "a text has no item",
        "The file is empty, or all of it is comments. A model has at least a `model` and an analysis; a file that others use has classes, functions or constants. `eng new NAME` writes a first model.",
        "// model Rotor { }",
        "model Rotor { }";
}
