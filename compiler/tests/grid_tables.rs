//! Tables of two and three arguments: the values that a model takes from the text and from files.

use eng_compiler::check::check;
use eng_compiler::elaborate::elaborate;
use eng_compiler::library::LIBRARY;
use eng_compiler::resolve::resolve;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::BindCode;
use eng_system::host::{Host, HostError};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Texts and files of a test, in memory.
struct Files(BTreeMap<&'static str, String>);

impl Host for Files {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        let text = self.0.get(path).cloned();
        text.ok_or_else(|| HostError::NotFound(path.to_owned()))
    }
}

/// The parameters (SI) of a model with some parameters that read tables of the module.
fn parameters(
    tables: &str,
    asked: &str,
    files: &[(&'static str, String)],
) -> BTreeMap<String, f64> {
    let model = format!(
        "{tables}\nmodel M {{\n gravity = [0, 0, 0] m/s^2\n body mass {{ mass = 1 kg; inertia = [1, 1, 1] kg*m^2 }}\n{asked}\n}}\n"
    );
    let mut texts: BTreeMap<&'static str, String> = files.iter().cloned().collect();
    texts.insert("test.eng", model);
    let host = Files(texts);
    let (mut sources, mut diagnostics) = (SourceMap::new(), Diagnostics::new());
    let program = resolve("test.eng", &host, LIBRARY, &mut sources, &mut diagnostics);
    let typed = check(program, &sources, &mut diagnostics);
    let model = typed
        .program
        .lookup(typed.program.root(), "M")
        .expect("a model");
    let made = elaborate(&typed, &mut sources, &host, model, &[], &mut diagnostics);
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:#?}");
    let made = made.expect("a system");
    let none = vec![None; made.system.parameters.len()];
    let bound = made.bind.bind(&none, &made.system.tables).expect("it fits");
    let names = made.system.parameters.iter().map(|p| p.origin.path.clone());
    names.zip(bound.parameters).collect()
}

#[test]
fn a_table_of_the_text_has_its_units_arguments_by_name_and_ends() {
    let tables = r#"
table push(x: Length, turn: Angle) -> Force = points([0, 10, 20] mm, [0, 90, 180, 270] deg,
    [[1, 2, 3, 2], [2, 4, 6, 4], [3, 6, 9, 6]] N, x: [linear, hold], turn: periodic(360 deg))
"#;
    let asked = "
    param there: Force = push(10 mm, 90 deg)
    param between: Force = push(5 mm, 450 deg)
    param by_name: Force = push(turn: -90 deg, x: 20 mm)
    param before: Force = push(-10 mm, 180 deg)
    param beyond: Force = push(50 mm, 180 deg)";
    let found = parameters(tables, asked, &[]);
    // (1 + x/10 mm)·(2 − cos(turn)) at the points of the turn; linear in x
    for (name, exact) in [
        ("there", 4.0),
        ("between", 3.0),
        ("by_name", 6.0),
        ("before", 0.0),
        ("beyond", 9.0),
    ] {
        assert!(
            (found[name] - exact).abs() < 1e-12,
            "{name}: {}",
            found[name]
        );
    }
}

#[test]
fn tables_of_a_file_take_their_columns_by_name_and_rows_in_any_order() {
    // x² y z and x − y + z over uneven points, rows shuffled by a step prime to their number
    let (x, y, z) = ([0.0, 1.0, 2.5, 4.0], [-1.0, 0.5, 2.0], [0.0, 10.0]);
    let mut rows = Vec::new();
    for a in x {
        for b in y {
            for c in z {
                rows.push(
                    format!("{c};{};{};{a};{}", a * a * b * c, a - b + c, b).replace('.', ","),
                );
            }
        }
    }
    let mut file = String::from("# a map\nz;product [kN];sum;x [mm];y\n");
    for k in 0..rows.len() {
        writeln!(file, "{}", rows[(k * 7) % rows.len()]).expect("text");
    }
    let tables = r#"
table product(x: Length, y: 1, z: 1) -> Force = csv("map.csv", columns: ["x [mm]", "y", "z", "product [kN]"], x: [even, none])
table total(x: Length, z: 1, y: 1) -> 1 = csv("map.csv", columns: ["x [mm]", "z", "y", "sum"], z: hold)
"#;
    let asked = "
    param a: Force = product(3 mm, 1, 4)
    param b: Force = product(-3 mm, 1, 4)
    param c = total(3 mm, 4, 1)
    param d = total(y: 1, x: 3 mm, z: 40)";
    let found = parameters(tables, asked, &[("map.csv", file)]);
    assert_eq!(found["a"], found["b"]);
    assert!((found["a"] - 36e3).abs() < 1e-8, "{}", found["a"]);
    assert!((found["c"] - 6.0).abs() < 1e-12 && (found["d"] - 12.0).abs() < 1e-12);
}

#[test]
fn slopes_of_tables_and_functions_are_exact() {
    let text = r#"
table wave(t: Angle) -> Length = points([0, 90, 180, 270] deg, [0, 1, 0, -1] mm, periodic: 360 deg)
fn cubic(x: Length) -> Force = 2 N/mm^3 * x^3
fn scaled<D>(x: D) -> D^2 = 3*x^2
fn twice(x: Length) -> Force/Length = slope(cubic, x)
fn outer(x: Length) -> Length { let inside = x; inside*slope(own, x)*1 m }
fn own(y: Length) -> 1 = y^2/1 m^2
"#;
    let asked = "
    param x: Length = 2 mm
    fn around(y: Length) -> Length^2 = x*y
    param first: Stiffness = slope(cubic, x)
    param second: Force/Length^2 = curvature(cubic, x)
    param nested: Force/Length^2 = slope(twice, x)
    param generic: Length = slope(scaled, x)
    param captured: Length = slope(around, x)
    param product = slope(outer, x)
    param rise: Length/Angle = slope(wave, 0 deg)
    param bend: Length/Angle^2 = curvature(wave, 90 deg)
    param repeats: Angle = period(wave)
    param never: Length = period(cubic)
    param place = 1.5*index_of([3, 1, 2] mm, 2 mm)";
    let found = parameters(text, asked, &[]);
    // the periodic spline through sin at quarter turns: slope m at 0 with 4 m = 6/(pi/2), and moment -3
    // (2/pi)^2 at 90 deg
    let quarter = core::f64::consts::FRAC_PI_2;
    for (name, exact) in [
        ("first", 24e3),
        ("second", 24e6),
        ("nested", 24e6),
        ("generic", 12e-3),
        ("captured", 2e-3),
        // the slope of x·own'(x) by x = 2 x²: 4 x
        ("product", 8e-3),
        ("rise", 1.5e-3 / quarter),
        ("bend", -3e-3 / (quarter * quarter)),
        ("repeats", 4.0 * quarter),
        ("never", 0.0),
        ("place", 4.5),
    ] {
        let (value, size) = (found[name], f64::max(1e-9, f64::abs(exact)));
        assert!(
            (value - exact).abs() < 1e-12 * size.max(1e-3),
            "{name}: {value} {exact}"
        );
    }
}

#[test]
fn functions_and_tables_with_some_arguments_are_functions() {
    let tables = "
fn burnt(angle: Angle, shape: 1, begin: Angle = 0 deg, n: Int = 2) -> 1 = shape*((angle - begin)/1 rad)^n
fn weighted<D>(x: D, y: D, share: 1) -> D = share*x + (1 - share)*y
table push(x: Length, turn: Angle) -> Force = points([0, 10, 20] mm, [0, 90, 180, 270] deg,
    [[1, 2, 3, 2], [2, 4, 6, 4], [3, 6, 9, 6]] N, x: [linear, hold], turn: periodic(360 deg))
fn steep = burnt(shape: 5)
fn late = steep(begin: 1 rad)
fn early = weighted(share: 0.25)
fn at_90 = push(turn: 90 deg)
fn rate = slope(late)
fn there(f: fn(Angle) -> 1) -> 1 = f(3 rad)
fn middle(f: fn(Length, Length) -> Length) -> Length = f(4 mm, 8 mm)
record Fuel { let burn: fn(Angle) -> 1 }
const Diesel = Fuel(burn: burnt(shape: 7, n: 3))
";
    let asked = "
    let law: fn(Angle) -> 1 = burnt(shape: 9)
    param by_name = late(3 rad)
    param again = late(angle: 3 rad, n: 3)
    param passed = there(burnt(shape: 2, begin: 1 rad))
    param of_record = Diesel.burn(2 rad)
    param of_value = law(1 rad)
    param generic: Length = middle(weighted(share: 0.75))
    param twice: Force = early(4 N, 8 N)
    param of_table: Force = at_90(5 mm)
    param slope_of_table: Stiffness = slope(at_90, 5 mm)
    param slope_of_call: 1/Angle = slope(burnt(shape: 3), 2 rad)
    param rate_there: 1/Angle = rate(3 rad)";
    let found = parameters(tables, asked, &[]);
    for (name, exact) in [
        ("by_name", 20.0),
        ("again", 40.0),
        ("passed", 8.0),
        ("of_record", 56.0),
        ("of_value", 9.0),
        ("generic", 5e-3),
        ("twice", 7.0),
        ("of_table", 3.0),
        ("slope_of_table", 200.0),
        ("slope_of_call", 12.0),
        ("rate_there", 20.0),
    ] {
        let error = (found[name] / exact - 1.0).abs();
        assert!(error < 1e-12, "{name}: {}", found[name]);
    }
}
