//! The standard library's texts, compiled into the program.
//!
//! This module contains the texts of `stdlib/` and their module paths. It must not depend on their contents.

/// Module paths and texts, for [`crate::resolve`]. A model takes names from them: `use std.joints.Revolute`.
pub const LIBRARY: &[(&str, &str)] = &[
    ("std.prelude", include_str!("../../stdlib/prelude.eng")),
    ("std.units", include_str!("../../stdlib/units.eng")),
    ("std.constants", include_str!("../../stdlib/constants.eng")),
    ("std.materials", include_str!("../../stdlib/materials.eng")),
    ("std.sections", include_str!("../../stdlib/sections.eng")),
    ("std.cranks", include_str!("../../stdlib/cranks.eng")),
    ("std.oils", include_str!("../../stdlib/oils.eng")),
    ("std.joints", include_str!("../../stdlib/joints.eng")),
    ("std.drives", include_str!("../../stdlib/drives.eng")),
    ("std.math", include_str!("../../stdlib/math.eng")),
    ("std.frames", include_str!("../../stdlib/frames.eng")),
    ("std.forces", include_str!("../../stdlib/forces.eng")),
    ("std.contacts", include_str!("../../stdlib/contacts.eng")),
    (
        "std.drivelines",
        include_str!("../../stdlib/drivelines.eng"),
    ),
    ("std.gas", include_str!("../../stdlib/gas.eng")),
    ("std.mounts", include_str!("../../stdlib/mounts.eng")),
    (
        "std.valvetrain",
        include_str!("../../stdlib/valvetrain.eng"),
    ),
    ("std.journals", include_str!("../../stdlib/journals.eng")),
    ("std.thrust", include_str!("../../stdlib/thrust.eng")),
    ("std.liners", include_str!("../../stdlib/liners.eng")),
    ("std.cylinder", include_str!("../../stdlib/cylinder.eng")),
    ("std.engine", include_str!("../../stdlib/engine.eng")),
    ("std.layouts", include_str!("../../stdlib/layouts.eng")),
    ("std.quick", include_str!("../../stdlib/quick.eng")),
];

/// Data files of the library's tables, by the names that its texts give to `csv`.
pub(crate) const FILES: &[(&str, &str)] = &[
    ("reynolds.csv", include_str!("../../stdlib/reynolds.csv")),
    ("thrust.csv", include_str!("../../stdlib/thrust.csv")),
];
