//! Small texts and their trees.

use crate::common::{expr, messages, parsed, tree, unit};
use eng_grammar::ast::{Expr, ExprKind, ItemKind, Statement};
use eng_grammar::{
    Diagnostics, MessagePart, SourceId, parse_expression, parse_message, parse_placeholder,
};

fn expression(text: &str) -> String {
    let mut diagnostics = Diagnostics::new();
    let value = parse_expression(text, SourceId(0), 0, &mut diagnostics);
    assert!(diagnostics.is_empty(), "{text}: {diagnostics:?}");
    expr(&value.expect("an expression"))
}

#[test]
fn operators_bind_as_documented() {
    for (text, expected) in [
        ("a or b and not c == d", "(or a (and b (not (== c d))))"),
        ("a + b*c^d^e", "(+ a (* b (^ c (^ d e))))"),
        ("-a^2", "(neg (^ a 2))"),
        ("-a*b", "(* (neg a) b)"),
        ("2^-1*3", "(* (^ 2 (neg 1)) 3)"),
        ("a - b - c", "(- (- a b) c)"),
        ("a/b/c", "(/ (/ a b) c)"),
        ("1..n + 1", "(range 1 (+ n 1))"),
        ("1 .. 6 by 2 + 1", "(range 1 6 by (+ 2 1))"),
        ("x == 1 .. 2", "(== x (range 1 2))"),
        ("a < b and b <= c", "(and (< a b) (<= b c))"),
        (
            "if a > b then c + 1 else if d then e else f",
            "(if (> a b) (+ c 1) (if d e f))",
        ),
        ("(if a then 1 else 2) + 3", "(+ (paren (if a 1 2)) 3)"),
        ("not not a", "(not (not a))"),
        ("--a", "(neg (neg a))"),
    ] {
        assert_eq!(expression(text), expected, "{text}");
    }
}

/// The tree of an expression in a program whose units are m, mm, s and N.
fn with_units(text: &str) -> Expr {
    let mut diagnostics = Diagnostics::new();
    let is_unit = |word: &str| ["m", "mm", "s", "N"].contains(&word);
    let value = parse_placeholder(text, SourceId(0), 0, Some(&is_unit), &mut diagnostics);
    assert!(diagnostics.is_empty(), "{text}: {diagnostics:?}");
    value.expect("an expression").0
}

#[test]
fn a_word_that_is_no_unit_ends_the_unit() {
    for (text, expected) in [
        ("2 N/m*s", "2<N m^-1 s>"),
        ("2 N/m*depth", "(* 2<N m^-1> depth)"),
        ("2 N/depth*m", "(* (/ 2<N> depth) m)"),
        ("1/2 N*a", "(* (/ 1 2<N>) a)"),
        ("-2 N*a", "(* -2<N> a)"),
        ("2 N*a^2*b^-1", "(* (* 2<N> (^ a 2)) (^ b (neg 1)))"),
        ("2 N*a^(1/2)", "(* 2<N> (^ a (/ 1 2)))"),
        ("2 N*a^k", "(* 2<N> (^ a k))"),
        ("b^2 N*a", "(* (^ b 2<N>) a)"),
        ("2 N/(a*m)^2*b", "(* (/ 2<N> (^ (paren (* a m)) 2)) b)"),
        ("2 N/(mm*s)*b", "(* 2<N mm^-1 s^-1> b)"),
        ("[1, 2] N*a + 3", "(+ (* [1, 2]<N> a) 3)"),
        ("(1 + 2 N*a) N*b", "(* (paren (+ 1 (* 2<N> a)))<N> b)"),
        ("f(2 N*a)", "(call f ((* 2<N> a)))"),
        ("2 N*a > 3 N*b and c", "(and (> (* 2<N> a) (* 3<N> b)) c)"),
        // a first word that is no unit is a mistake in a unit
        ("2 a*m", "2<a m>"),
    ] {
        assert_eq!(expr(&with_units(text)), expected, "{text}");
    }
    let ExprKind::Binary {
        op_span,
        left,
        right,
        ..
    } = with_units("12 N*depth^2").kind
    else {
        panic!("a product")
    };
    let places = [left.span, op_span, right.span].map(|span| (span.start, span.end));
    assert_eq!(places, [(0, 4), (4, 5), (5, 12)]);
    // the limit of depth counts the factors after units
    let long = format!("2 N{}", "*a".repeat(300));
    let mut diagnostics = Diagnostics::new();
    let is_unit = |word: &str| word == "N";
    parse_placeholder(&long, SourceId(0), 0, Some(&is_unit), &mut diagnostics);
    assert!(diagnostics.has_errors(), "300 factors");
}

fn items_of(text: &str) -> String {
    let (file, diagnostics) = parsed(text);
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    tree(&file.items)
}

#[test]
fn a_choice_has_words_and_its_chains_may_end_without_else() {
    assert_eq!(
        items_of("choice End = timing_end\n    | driving_end\nchoice One = only"),
        "(choice End timing_end driving_end)\n(choice One only)\n"
    );
    for (text, expected) in [
        ("if a == b then 1", "(if (== a b) 1)"),
        ("if a then 1 else if b then 2", "(if a 1 (if b 2))"),
        ("(if a then 1) + 2", "(+ (paren (if a 1)) 2)"),
    ] {
        assert_eq!(expression(text), expected, "{text}");
    }
    // `choice` is a name elsewhere
    assert_eq!(items_of("let choice = 3"), "(let choice = 3)\n");
}

#[test]
fn units_bind_tightest_and_end_in_time() {
    for (text, expected) in [
        ("54 mm", "54<mm>"),
        ("54mm", "54<mm>"),
        ("5 %", "5<%>"),
        ("1.5e-3 N*m/rad", "0.0015~<N m rad^-1>"),
        ("2 kg/(m*s)^2", "2<kg m^-2 s^-2>"),
        ("2 V/m^(1/2)", "2<V m^-1/2>"),
        ("3 m^-1", "3<m^-1>"),
        ("1/2 mm", "(/ 1 2<mm>)"),
        ("5 mm * x", "(* 5<mm> x)"),
        ("5 mm*x", "5<mm x>"),
        ("5 mm*f(x)", "(* 5<mm> (call f (x)))"),
        ("5 mm*a[1]", "(* 5<mm> (at a 1))"),
        ("5 mm*a.b", "(* 5<mm> a.b)"),
        ("5 mm*(a + b)", "(* 5<mm> (paren (+ a b)))"),
        ("5 mm*2", "(* 5<mm> 2)"),
        ("5 mm//x", "5<mm>"),
        ("[0, 0, -41] mm", "[0, 0, (neg 41)]<mm>"),
        (
            "[i*2 for i in 1..3, j in 1..2] mm",
            "(for [i in (range 1 3), j in (range 1 2)] (* i 2))<mm>",
        ),
        ("(a + b) mm^2", "(paren (+ a b))<mm^2>"),
        (
            "1000 rpm .. 6000 rpm by 250 rpm",
            "(range 1000<rpm> 6000<rpm> by 250<rpm>)",
        ),
        ("1 rpm..2 rpm", "(range 1<rpm> 2<rpm>)"),
        ("1..4", "(range 1 4)"),
        ("1.5", "1.5~"),
        ("5", "5"),
        ("5.0", "5~"),
        ("5e3", "5000~"),
        ("2 and 3", "(and 2 3)"),
        ("2 or 3", "(or 2 3)"),
        ("1..4 by 2", "(range 1 4 by 2)"),
        ("if a then 1 else 2", "(if a 1 2)"),
        (
            "sum(2 for i in 1..4)",
            "(call sum ((for [i in (range 1 4)] 2)))",
        ),
        ("5 mm == x", "(== 5<mm> x)"),
    ] {
        assert_eq!(expression(text), expected, "{text}");
    }
}

#[test]
fn a_unit_stands_on_its_line() {
    let text = "let a = 5\nmm = 3\nlet b = [1, 2]\non = (c)\nparam d = 1 kg; start = 2";
    let (file, diagnostics) = parsed(text);
    assert!(diagnostics.is_empty(), "{}", messages(text));
    assert_eq!(
        tree(&file.items),
        "(let a = 5)\n(mm = 3)\n(let b = [1, 2])\n(on = (paren c))\n(param d = 1<kg>)\n(start = 2)\n"
    );
}

#[test]
fn a_sign_belongs_to_a_literal_with_a_unit() {
    for (text, expected) in [
        ("-5 degC", "-5<degC>"),
        ("- 5 degC", "-5<degC>"),
        ("a - 5 degC", "(- a 5<degC>)"),
        ("a - -5 degC", "(- a -5<degC>)"),
        ("f(-5 degC)", "(call f (-5<degC>))"),
        ("2*-5 mm", "(* 2 -5<mm>)"),
        ("-5", "(neg 5)"),
        ("-5 mm ^ 2", "(neg (^ 5<mm> 2))"),
        ("--5 mm", "(neg -5<mm>)"),
        ("-(5 mm)", "(neg (paren 5<mm>))"),
    ] {
        assert_eq!(expression(text), expected, "{text}");
    }
}

#[test]
fn calls_indices_fields() {
    for (text, expected) in [
        ("main[j].force.x", "(at main j).force.x"),
        ("piston[*].pin", "(at piston *).pin"),
        ("pin[i, 2*b]", "(at pin i (* 2 b))"),
        ("f()", "(call f ())"),
        ("f(a, b: c, d: e,)", "(call f (a, b: c, d: e))"),
        (
            "sum(f(i) for i in 1..4)",
            "(call sum ((for [i in (range 1 4)] (call f (i)))))",
        ),
        ("[a, b].x", "[a, b].x"),
        ("(a - b).x", "(paren (- a b)).x"),
        ("[]", "[]"),
        (
            "force.state.output(body: part)",
            "(call force.state.output (body: part))",
        ),
        (
            "\"a \\\"b\\\" \\\\ \\n\\t.\"",
            "\"a \\\"b\\\" \\\\ \\n\\t.\"",
        ),
        ("true and false", "(and true false)"),
        (
            "forest + iffy + not_a + inn",
            "(+ (+ (+ forest iffy) not_a) inn)",
        ),
    ] {
        assert_eq!(expression(text), expected, "{text}");
    }
}

#[test]
fn items() {
    let text = r#"//! The file.
//! Second line.
use std.units.*
use std.joints.{Revolute, Fixed}
use oils.House
dimension Length
dimension Force = Mass*Length/Time^2
dimension Root = Time^(-2/4)
dimension Temperature = point TemperatureDifference
unit m: Length
unit kN = 1e3 N
unit % = 0.01
unit degC: Temperature = 1 K from 273.15 K
/// Of the cylinder.
param bore: Length = 86 mm in (10 mm, 500 mm)
param stroke = 30 mm in (1 mm, 2 mm) as mm
param ratio = 5 as %
const order: Int[4] = [1, 3, 4, 2]
let list: Force/Area[n + 1] = x
let pair: (Force/Area)[2][3] = x
fn clamp<D>(x: D, low: D, high: D) -> D { let y = max(x, low); let z = y
    min(z, high) }
fn area(r: Length = 2 mm in (1 mm, 3 mm)) = pi*r^2
fn apply_law(law: fn(CrankAngle, 1) -> Vector<Force>) -> 1/Time = law(0 deg, 1)
table gas(theta: CrankAngle) -> AbsolutePressure = csv("gas.csv", periodic: 720 deg)
"#;
    let (file, diagnostics) = parsed(text);
    assert!(diagnostics.is_empty(), "{}", messages(text));
    insta::assert_snapshot!(format!("{:?}\n{}", file.docs, tree(&file.items)));
}

#[test]
fn declarations_and_statements() {
    let text = r#"
model Engine {
    gravity = [-9.81, 0, 0] m/s^2
    cycle angle = rotation(crank.flange, ground) { period = 720 deg }
    body rod[i in 1..4, b in [1, 2]] { mass = 0.62 kg; marker big = [0, -41, 0] mm }
    joint pin[i in 1..4] = Revolute(rod[i].big, crank.pin[i]) { branch travel > 0 mm }
    start rotation(crank.main[1], rail) = 30 deg
    guess position = [0, 0, 0] mm
    output force[j in 1..5]: Vector<Force> = main[j].force in block.main[j] as kN
    output state = 5 mm
    param = 3
    body = 4
    force = 3 N
    output = 5
    default journal { }
}
/// A law.
force Law(
    /// Moves.
    a: Marker,
    b: Marker, k: Stiffness = 2 N/mm,
) : Interface {
    state p: Pressure = 3 bar
    state lift: Length = 0 mm scale 0.1*k
    state n: 1 = 0 scale 1
    der(p) = (2 bar - p)/(1 s)
    apply force force on a against b
    apply torque (1 + 2) N*m on a
    apply force 5 N on a
    constrain a.origin == b.origin
    branch dot(a.z, b.z) > 0
    require k > 0 N/m else "stiffness {k as N/mm} \"k\""
    advise k < 1e9 N/m else "large"
    advise usual: k < 1e9 N/m else "large"
    accept usual, short
    let start = 3; let on = start
}
interface Nothing {}
record Oil { let a: Viscosity; fn f(t: Temperature) -> Viscosity = a }
analysis sweep[s in 1 rpm .. 2 rpm by 1 rpm] = transient(Engine(speed: s))
"#;
    let (file, diagnostics) = parsed(text);
    assert!(diagnostics.is_empty(), "{}", messages(text));
    insta::assert_snapshot!(tree(&file.items));
}

#[test]
fn reports() {
    let text = r#"
/// Of a paper.
report bearings "Main \"bearings\"" {
    /// A caption.
    figure force "Vertical" = history(run.vertical[1..5], over: time) as kN
    value peak = maximum(run.vertical[*])
    let late = peak
    require peak < 5 kN else "{peak as kN}"
}
report empty {}
"#;
    let (file, diagnostics) = parsed(text);
    assert!(diagnostics.is_empty(), "{}", messages(text));
    insta::assert_snapshot!(tree(&file.items));
}

#[test]
fn spans_cover_the_text_and_nothing_behind_it() {
    let text = "let a = b + 54 mm   // comment\n\nlet c = f(x)[1]\n";
    let (file, _) = parsed(text);
    let at = |span: eng_grammar::Span| &text[span.start as usize..span.end as usize];
    let shown: Vec<_> = file.items.iter().map(|item| at(item.span)).collect();
    assert_eq!(shown, ["let a = b + 54 mm", "let c = f(x)[1]"]);
    let ItemKind::Binding(binding) = &file.items[0].kind else {
        panic!("a binding")
    };
    let value = binding.value.as_ref().expect("a value");
    assert_eq!(at(value.span), "b + 54 mm");
    let ExprKind::Binary { op_span, right, .. } = &value.kind else {
        panic!("a sum")
    };
    assert_eq!((at(*op_span), at(right.span)), ("+", "54 mm"));
}

#[test]
fn part_of_a_text_keeps_its_places() {
    let mut diagnostics = Diagnostics::new();
    let (value, display) =
        parse_placeholder("a + b as mm/s", SourceId(3), 100, None, &mut diagnostics).expect("both");
    assert_eq!(expr(&value), "(+ a b)");
    assert_eq!(display.as_ref().map(unit), Some("<mm s^-1>".to_string()));
    assert_eq!(
        (value.span.source, value.span.start, value.span.end),
        (SourceId(3), 100, 105)
    );
    assert!(diagnostics.is_empty());
    assert!(parse_expression("a +", SourceId(3), 100, &mut diagnostics).is_none());
    let wrong = diagnostics.iter().next().expect("a message");
    assert_eq!(wrong.title, "expected a value after `+`");
    assert_eq!(wrong.labels[0].span.start, 102);
}

#[test]
fn messages_split_into_texts_and_values() {
    let text = "require a else \"x {{y}} \\\"{b + 1 as mm}\\\" and {c}\"";
    let (file, diagnostics) = parsed(text);
    assert!(diagnostics.is_empty());
    let ItemKind::Statement(Statement::Require { message, .. }) = &file.items[0].kind else {
        panic!("a require")
    };
    let span = message.span;
    assert_eq!(&text[span.start as usize..span.end as usize], message.text);
    let mut diagnostics = Diagnostics::new();
    let shown: Vec<String> = parse_message(message, None, &mut diagnostics)
        .into_iter()
        .map(|part| match part {
            MessagePart::Text(text) => text,
            MessagePart::Value {
                value,
                unit: shown,
                span,
            } => {
                assert!(text[span.start as usize..span.end as usize].starts_with('{'));
                format!(
                    "<{} {}>",
                    expr(&value),
                    shown.as_ref().map_or(String::new(), unit)
                )
            }
        })
        .collect();
    assert_eq!(shown, ["x {y} \"", "<(+ b 1) <mm>>", "\" and ", "<c >"]);
    assert!(diagnostics.is_empty());
}
