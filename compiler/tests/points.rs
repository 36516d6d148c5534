//! Points and differences: a value that is declared as one is never accepted as the other.

use crate::check_support::run_in;

/// A point's dimension, names of its difference, a unit.
const FAMILIES: [(&str, &[&str], &str); 3] = [
    (
        "AbsolutePressure",
        &["GaugePressure", "Pressure", "Stress", "Force/Area"],
        "bar",
    ),
    ("Temperature", &["TemperatureDifference"], "K"),
    ("CrankAngle", &["Angle"], "deg"),
];

/// A place where a value of the type FROM becomes one of the type TO. Top-level text, and text in a
/// model where `v` is of the type FROM, `w` of the type TO, and `b` a body.
const PLACES: [(&str, &str, &str); 33] = [
    ("let", "", "let x: TO = v\noutput o = [x]"),
    ("param", "", "param x: TO = v"),
    ("const", "const c: FROM = 2 UNIT\nconst d: TO = c", ""),
    (
        "limit",
        "const c: FROM = 1 UNIT",
        "param x: TO = 2 UNIT in (c, 5 UNIT)",
    ),
    ("output", "", "output x: TO = v"),
    (
        "argument of a function",
        "fn f(x: TO) -> 1 = if x > 1 UNIT then 1 else 2",
        "output o = f(v)",
    ),
    (
        "named argument",
        "fn f(y: 1, x: TO) -> 1 = if x > 1 UNIT then y else 2",
        "output o = f(x: v, y: 3)",
    ),
    (
        "result of a function",
        "fn f(x: FROM) -> TO = x",
        "output o = [f(v)]",
    ),
    (
        "default of a function",
        "fn f(y: 1 = 1, x: TO = 3 UNIT) -> 1 = if x > 1 UNIT then y else 2",
        "output o = f(1, v)",
    ),
    (
        "generic function",
        "fn first<D>(x: D, y: D) -> D = if x > y then x else y",
        "output o = [first(v, w)]",
    ),
    (
        "argument of a class",
        "force K(a: Marker, x: TO) { output y: TO = x }",
        "force k = K(b.origin, x: v)",
    ),
    (
        "default of a class",
        "force K(a: Marker, z: FROM, x: TO = z) { output y = [x] }",
        "force k = K(b.origin, z: v)",
    ),
    (
        "block of a use",
        "force K(a: Marker, x: TO) { output y: TO = x }",
        "force k = K(b.origin, x: 2 UNIT) { require x > v else \"small\" }",
    ),
    (
        "state",
        "force K(a: Marker, z: FROM) { state s: TO = z; der(s) = (z - z)/1 s }",
        "force k = K(b.origin, z: v)",
    ),
    (
        "argument of a component",
        "component P(m: Marker, x: TO) { output y: TO = x }",
        "part p = P(b.origin, x: v)",
    ),
    (
        "output of a part",
        "component P(m: Marker, x: FROM) { output y: FROM = x }",
        "part p = P(b.origin, x: v)\nlet z: TO = p.y\noutput o = [z]",
    ),
    (
        "output of an element",
        "force K(a: Marker, x: FROM) { output y: FROM = x }",
        "force k = K(b.origin, x: v)\nlet z: TO = k.y\noutput o = [z]",
    ),
    (
        "model of an analysis",
        "const c: FROM = 2 UNIT\nmodel N { param x: TO = 2 UNIT\nbody b { mass = 1 kg; inertia = [1, 1, 1] g*m^2 } }\nanalysis n = assemble(N(x: c))",
        "",
    ),
    (
        "sweep",
        "const c: FROM = 2 UNIT\nmodel N { param x: TO = 2 UNIT\nbody b { mass = 1 kg; inertia = [1, 1, 1] g*m^2 } }\nanalysis n[x in [c, c]] = assemble(N(x: x))",
        "",
    ),
    (
        "result of a function type",
        "fn q(t: Time) -> FROM = 2 UNIT\nforce L(a: Marker, law: fn(Time) -> TO) { output y: TO = law(time) }",
        "force l = L(b.origin, law: q)",
    ),
    (
        "argument of a function type",
        "fn q(x: FROM) -> 1 = if x > 1 UNIT then 1 else 2\nforce L(a: Marker, law: fn(TO) -> 1) { output y = law(2 UNIT) }",
        "force l = L(b.origin, law: q)",
    ),
    (
        "table as a function",
        "table q(t: Time) -> FROM = points([0, 1] s, [1, 2] UNIT)\nforce L(a: Marker, law: fn(Time) -> TO) { output y: TO = law(time) }",
        "force l = L(b.origin, law: q)",
    ),
    (
        "argument of a table as a function",
        "table q(x: FROM) -> 1 = points([0, 1] UNIT, [1, 2])\nforce L(a: Marker, law: fn(TO) -> 1) { output y = law(2 UNIT) }",
        "force l = L(b.origin, law: q)",
    ),
    (
        "argument of a table",
        "table q(x: TO) -> 1 = points([0, 1] UNIT, [1, 2])",
        "output o = q(v)",
    ),
    (
        "result of a table",
        "table q(t: Time) -> FROM = points([0, 1] s, [1, 2] UNIT)",
        "let x: TO = q(1 s)\noutput o = [x]",
    ),
    (
        "points of a table",
        "const c: FROM = 2 UNIT\ntable q(t: Time) -> TO = points([0, 1] s, [c, c])",
        "output o = [q(1 s)]",
    ),
    (
        "field of a record",
        "record R { let x: TO }",
        "let r = R(x: v)\noutput o = [r.x]",
    ),
    ("comparison", "", "output o = if v < w then 1 else 2"),
    ("requirement", "", "require v == w else \"not equal\""),
    ("min", "", "output o = [min(v, w)]"),
    ("list", "", "let l = [v, w]\noutput o = l"),
    ("if", "", "output o = [if time > 1 s then v else w]"),
    (
        "array",
        "fn f(x: TO[2]) -> 1 = if x[1] > 1 UNIT then 1 else 2",
        "output o = f([v, v])",
    ),
];

fn errors(text: &str) -> Vec<(String, String)> {
    let run = run_in("/nowhere", "points.eng", text);
    run.diagnostics
        .iter()
        .filter(|d| d.is_error())
        .map(|d| (d.code.to_owned(), d.title.clone()))
        .collect()
}

fn text_of((top, inside): (&str, &str), from: &str, to: &str, unit: &str) -> String {
    let model = "
model M {
    param v: FROM = 2 UNIT
    param w: TO = 3 UNIT
    body b { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    INSIDE
}
TOP
";
    model
        .replace("INSIDE", inside)
        .replace("TOP", top)
        .replace("FROM", from)
        .replace("TO", to)
        .replace("UNIT", unit)
}

#[test]
fn a_point_and_a_difference_are_not_taken_for_each_other_anywhere() {
    let mut wrong = Vec::new();
    for (point, differences, unit) in FAMILIES {
        for difference in differences {
            for (place, top, inside) in PLACES {
                for (from, to, refused) in [
                    (*difference, point, true),
                    (point, *difference, true),
                    (point, point, false),
                    (*difference, *difference, false),
                ] {
                    let found = errors(&text_of((top, inside), from, to, unit));
                    let told = found.iter().all(|(code, _)| {
                        ["E0306", "E0307", "E0309", "E0314"].contains(&code.as_str())
                    });
                    if found.is_empty() == refused || (refused && !told) {
                        wrong.push(format!("{place}: {from} as {to}: {found:?}"));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Computed values keep the kind that is certain.
#[test]
fn computed_values_stay_what_they_are() {
    let told = |value: &str, ty: &str| {
        let text = format!(
            "model M {{
    param g: GaugePressure = 2 bar
    param p: AbsolutePressure = 3 bar
    param ambient: AbsolutePressure = 1 bar
    param share: 1 = 0.5
    param a: Length = 3 mm
    param b: Length = 2 mm
    let x: {ty} = {value}
    output o = [x]
    output used = [g, p - ambient, share*1 bar, a/b*1 bar]
    body c {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2 }}
}}"
        );
        let found = errors(&text);
        assert!(
            found.iter().all(|(code, _)| code == "E0306"),
            "{value}: {found:?}"
        );
        !found.is_empty()
    };
    for value in [
        "-g",
        "abs(g)",
        "g - 1 bar",
        "share*g",
        "g/2",
        "g*(a/b)",
        "g + g",
        "p - ambient",
        "norm([g, g])",
        "max(g, 1 bar)",
        "sum([g, g])",
    ] {
        assert!(told(value, "AbsolutePressure"), "{value}");
        assert!(!told(value, "GaugePressure"), "{value}");
    }
    for value in [
        "g + ambient",
        "p + 1 bar - 0 bar + g",
        "min(p, 2 bar)",
        "p - g",
        "p*(a/b)^1.3",
        "if a > b then p else 2 bar",
    ] {
        assert!(!told(value, "AbsolutePressure"), "{value}");
    }
    for value in ["p + 1 bar", "p + g", "max(p, 1 bar)", "p - g"] {
        assert!(told(value, "GaugePressure"), "{value}");
    }
    // a literal in a plain unit may stand for either
    assert!(!told("2 bar", "AbsolutePressure") && !told("2 bar", "GaugePressure"));
}

/// The kinds that an interface promises.
#[test]
fn an_interface_tells_points_from_differences() {
    for (promised, given) in [
        ("Temperature", "TemperatureDifference"),
        ("GaugePressure", "AbsolutePressure"),
    ] {
        let unit = if promised == "Temperature" {
            "K"
        } else {
            "bar"
        };
        let text = |given: &str| {
            format!(
                "interface I {{ param a: Marker; param x: {promised}; output y: {promised} }}
force K(a: Marker, x: {given}) : I {{ output y: {given} = max(x, 2 {unit}) }}"
            )
        };
        let codes: Vec<String> = errors(&text(given)).into_iter().map(|e| e.0).collect();
        assert_eq!(codes, ["E0407", "E0407"]);
        assert!(errors(&text(promised)).is_empty());
    }
}

#[test]
fn a_start_is_a_difference_where_its_target_is() {
    let text = |ty: &str| {
        format!(
            "use std.joints.Spherical
model M {{
    param v: {ty} = 20 deg
    marker base = [0, 0, 0] mm
    body b {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2 }}
    joint ball = Spherical(b.origin, base)
    start ball.tilt = v
}}"
        )
    };
    assert_eq!(errors(&text("CrankAngle"))[0].0, "E0306");
    assert!(errors(&text("Angle")).is_empty());
}

/// `by 10 degC` would be a step of 283 K.
#[test]
fn the_step_of_a_range_is_a_difference() {
    let text = |ends: &str, step: &str| {
        format!(
            "const step: {step}
model N {{ param x: Temperature = 300 K
    body b {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2 }}
}}
analysis n[x in {ends} by step] = assemble(N(x: x))"
        )
    };
    for ends in ["20 degC .. 60 degC", "300 K .. 400 K"] {
        for point in ["Temperature = 10 K", "Temperature = 10 degC"] {
            let found: Vec<String> = errors(&text(ends, point))
                .into_iter()
                .map(|e| e.0)
                .collect();
            assert_eq!(found, ["E0306"], "{ends} by {point}");
        }
        assert!(errors(&text(ends, "TemperatureDifference = 10 K")).is_empty());
    }
    let literal =
        |step: &str| text("20 degC .. 60 degC", "1 = 1").replace("by step", &format!("by {step}"));
    assert_eq!(errors(&literal("10 degC"))[0].0, "E0306");
    assert!(errors(&literal("10 K")).is_empty());
}
