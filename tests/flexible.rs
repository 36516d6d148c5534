//! Flexible bodies from text to motion: a steel bar of 20 x 20 x 200 mm against beam theory and statics.

use crate::support::{program_of, program_with_bar as program};
use eng::{Quantity, Sources};
use std::f64::consts::PI;

// Material and shape of the bar, SI.
const YOUNG: f64 = 210e9;
const POISSON: f64 = 0.3;
const DENSITY: f64 = 7850.0;
const LENGTH: f64 = 0.2;
const SIDE: f64 = 0.02;

fn area() -> f64 {
    SIDE * SIDE
}

fn second_moment() -> f64 {
    SIDE.powi(4) / 12.0
}

const FREE: &str = "
    model Free {
        gravity = [0, 0, 0] m/s^2
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            modes = normal(7)
            damping = 1 %
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
            start angular_velocity = [300, 40, 500] rad/s
            start velocity = [1, -2, 0.5] m/s
        }
        output tip_velocity = bar.tip.velocity in ground
    }
    analysis fly = transient(Free(), duration: 5 ms, sample: 1 ms, step: 8 us)
    analysis finer = transient(Free(), duration: 5 ms, sample: 1 ms, step: 4 us)";

/// Mass to rounding; the first bending pair against Timoshenko's beam (Cowper's shear factor); the pair is a pair.
#[test]
fn a_free_bar_has_the_mass_and_frequencies_of_a_beam() {
    let model = program(FREE).model("Free").expect("a model");
    let bar = &model.reductions()[0];
    let mass = DENSITY * area() * LENGTH;
    assert!((bar.mass() / mass - 1.0).abs() < 1e-12, "{}", bar.mass());
    let f = bar.frequencies();
    // free-free Euler-Bernoulli beam, R. D. Blevins, Formulas for natural frequency and mode shape (1979), table 8-1
    let slender = 4.730_041_f64.powi(2) / (2.0 * PI)
        * (YOUNG * second_moment() / (DENSITY * area() * LENGTH.powi(4))).sqrt();
    assert!((f[1] / f[0] - 1.0).abs() < 1e-9, "{f:?}");
    // shear and rotary inertia take some per cent off
    assert!(
        f[0] < slender && f[0] > 0.93 * slender,
        "{} {slender}",
        f[0]
    );
}

/// A cube of one element, with the matrices of CalculiX.
const CUBE: &str = "*NODE
1, 0., 0., 0.\n2, 1., 0., 0.\n3, 1., 1., 0.\n4, 0., 1., 0.
5, 0., 0., 1.\n6, 1., 0., 1.\n7, 1., 1., 1.\n8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8
*MATERIAL, NAME=M\n*ELASTIC\n2.1E11, 0.3\n*DENSITY\n7850.
*SOLID SECTION, ELSET=E, MATERIAL=M
";

#[test]
fn a_mesh_of_calculix_without_rules_says_that_its_mass_is_another() {
    let reduced = |rules: &str| {
        let text = format!(
            "model M {{ flexible cube {{ mesh = calculix(\"cube.inp\", units: si); modes = normal(2); damping = 1 %; {rules} marker m = node(1) }} }}"
        );
        let sources = Sources::from_texts([
            ("cube.eng".to_owned(), text),
            ("cube.inp".to_owned(), CUBE.to_owned()),
        ]);
        let checked = eng::check(&sources, "cube.eng").into_program();
        let model = checked.expect("a program").model("M").expect("a model");
        model.reductions()[0].text()
    };
    let noted = |rules: &str| reduced(rules).contains("`element_rules = calculix` computes");
    assert!(noted(""));
    assert!(!noted("element_rules = calculix;") && !noted("element_rules = exact;"));
}

/// A symmetric matrix as a text OP4, one column after the other from its first row.
fn op4(name: &str, matrix: &eng_flexible::sparse::SymmetricMatrix) -> String {
    let size = matrix.size();
    let mut dense = vec![0.0; size * size];
    for column in 0..size {
        let (rows, values) = matrix.column(column);
        for (row, value) in rows.iter().zip(values) {
            dense[column * size + *row as usize] = *value;
            dense[*row as usize * size + column] = *value;
        }
    }
    let mut text = format!("{size:8}{size:8}{:8}{:8}{name:8}1P,3E23.16\n", 6, 2);
    for (column, values) in dense.chunks(size).enumerate() {
        text += &format!("{:8}{:8}{size:8}\n", column + 1, 1);
        for line in values.chunks(3) {
            for value in line {
                let number = format!("{value:.16e}");
                let (digits, exponent) = number.split_once('e').expect("an exponent");
                let exponent: i32 = exponent.parse().expect("a number");
                text += &format!("{:>23}", format!("{digits}E{exponent:+03}"));
            }
            text.push('\n');
        }
    }
    text += &format!(
        "{:8}{:8}{:8}\n{:>23}\n",
        size + 1,
        1,
        1,
        "1.0000000000000000E+00"
    );
    text
}

/// Matrices of an OP4, which does not name its rows: by ascending node number they are the bar's own.
#[test]
fn matrices_that_do_not_name_their_rows_are_taken_by_ascending_nodes() {
    use eng_flexible::fe::{Rules, assemble};
    struct Deck;
    impl eng_flexible::Files for Deck {
        fn open(&self, _: &str) -> std::io::Result<Box<dyn std::io::Read>> {
            Ok(Box::new(include_bytes!("mesh/bar.bdf").as_slice()))
        }
    }
    let mesh = eng_flexible::read_mesh(&Deck, "bar.bdf", eng_flexible::MeshFormat::Nastran)
        .expect("a mesh");
    let full = assemble(&mesh, &Rules::default()).expect("matrices in the deck's units");
    let mass = full.mass.assembled().expect("a mass");
    let check = |arguments: &str| {
        let text = FREE.replace(
            "modes = normal(7)",
            &format!("stiffness = op4(\"k.op4\", matrix: \"KGG\"{arguments}); mass = op4(\"m.op4\", matrix: \"MGG\"); modes = normal(7)"),
        );
        program_of(&[
            ("bar.eng", &text),
            ("bar.bdf", include_str!("mesh/bar.bdf")),
            ("k.op4", &op4("KGG", &full.stiffness)),
            ("m.op4", &op4("MGG", &mass)),
        ])
        .model("Free")
    };
    let own = program(FREE).model("Free").expect("a model");
    let read = check(", per_node: 3").expect("a model of the read matrices");
    let pairs = own.reductions()[0].frequencies().iter();
    for (a, b) in pairs.zip(read.reductions()[0].frequencies()) {
        assert!((a / b - 1.0).abs() < 1e-8, "{a} {b}");
    }
    // without the order the message explains how to state it, and with a wrong order it names the right one
    for (arguments, says) in [
        ("", "`per_node: 3` or `per_node: 6`"),
        (", per_node: 6", "state `per_node: 3`"),
    ] {
        let refused = check(arguments)
            .expect_err("rows without a name")
            .to_string();
        assert!(refused.contains(says), "{refused}");
    }
}

/// The matrices of a cube with its corners as interface, and its middle as the mean of the corners: a marker can use the middle,
/// and the exported shapes have it.
#[test]
fn a_node_that_a_matrix_recovers_is_a_node_of_the_body() {
    use eng_flexible::fe::{Rules, assemble};
    struct Deck;
    impl eng_flexible::Files for Deck {
        fn open(&self, _: &str) -> std::io::Result<Box<dyn std::io::Read>> {
            Ok(Box::new(CUBE.as_bytes()))
        }
    }
    let mesh = eng_flexible::read_mesh(&Deck, "cube.inp", eng_flexible::MeshFormat::CalculiX)
        .expect("a mesh");
    let full = assemble(&mesh, &Rules::default()).expect("matrices");
    let mass = full.mass.assembled().expect("a mass");
    let corners: String = (mesh.nodes.iter())
        .map(|node| {
            let [x, y, z] = node.position;
            format!("{},{x},{y},{z}\n", node.id)
        })
        .collect();
    let mean = |share: f64| -> String {
        let line = |row: usize| {
            let entries = (0..24).map(|column| if column % 3 == row { share } else { 0.0 });
            let entries: Vec<String> = entries.map(|x| x.to_string()).collect();
            entries.join(",") + "\n"
        };
        (0..3).map(line).collect()
    };
    let sources = |more: &str, share: f64| {
        let text = format!(
            "model M {{ flexible cube {{
                mesh = csv(\"corners.csv\", units: si)
                stiffness = op4(\"k.op4\", matrix: \"KGG\", per_node: 3)
                mass = op4(\"m.op4\", matrix: \"MGG\")
                recovery = csv(\"t.csv\", per_node: 3, nodes: csv(\"middle.csv\", units: si){more})
                modes = normal(2)
                damping = 1 %
                marker middle = node(9)
            }} }}"
        );
        let texts = [
            ("cube.eng", text),
            ("corners.csv", corners.clone()),
            ("middle.csv", "9,0.5,0.5,0.5\n".to_owned()),
            ("k.op4", op4("KGG", &full.stiffness)),
            ("m.op4", op4("MGG", &mass)),
            ("t.csv", mean(share)),
        ];
        Sources::from_texts(texts.map(|(name, text)| (name.to_owned(), text)))
    };
    let program = eng::check(&sources("", 0.125), "cube.eng").into_program();
    let program = program.unwrap_or_else(|report| panic!("{report}"));
    let model = program.model("M").expect("a model");
    let cube = &model.reductions()[0];
    let told = cube.text();
    let facts = "1 node by t.csv; they follow rigid motions of the interface within ";
    assert!(told.contains(facts), "{told}");
    let files = cube.files(eng::BodyFormat::Numpy, 1).expect("files");
    let shapes = files.iter().find(|file| file.name.ends_with(".shapes.npy"));
    let head = String::from_utf8_lossy(&shapes.expect("shapes").contents[..80]).into_owned();
    assert!(head.contains("(9, 6, 2,)"), "{head}");

    for (more, share, says) in [
        (
            "",
            0.12,
            "the difference is 0.04 of the motion, and 0.001 is allowed",
        ),
        (
            ", tolerance: 0",
            0.125,
            "`tolerance` of `csv` must be positive",
        ),
        (
            ", freedoms: \"t.dof\"",
            0.125,
            "both state the freedoms of the rows",
        ),
    ] {
        let told = match eng::check(&sources(more, share), "cube.eng").into_program() {
            Err(report) => report.to_string(),
            Ok(program) => program.model("M").expect_err("a refusal").to_string(),
        };
        assert!(told.contains(says), "{told}");
    }
    let accepted = eng::check(&sources(", tolerance: 5 %", 0.12), "cube.eng").into_program();
    let accepted = accepted.unwrap_or_else(|report| panic!("{report}"));
    let model = accepted.model("M").expect("a model");
    let told = model.reductions()[0].text();
    assert!(told.contains("within 0.04"), "{told}");
}

/// Energy of a free bar that spins fast, rings and hardly damps: the loss falls with the square of the step.
#[test]
fn a_free_bar_keeps_its_energy() {
    let program = program(FREE);
    let lost = |name: &str| {
        let analysis = program.analysis(name).expect("an analysis");
        let outcome = analysis.run(&mut |_| {}).expect("a run");
        let energy = outcome.summary.expect("a summary").energy;
        (energy.imbalance() / energy.kinetic).abs()
    };
    let (coarse, fine) = (lost("fly"), lost("finer"));
    assert!(coarse < 1e-4, "{coarse}");
    assert!((3.0..6.0).contains(&(coarse / fine)), "{coarse} {fine}");
}

const HELD: &str = "
    force Push(a: Marker, b: Marker, x: Force) {
        apply force x*b.x on a
    }
    model Held {
        param push: Force = 1000 N
        gravity = [0, 0, -9.81] m/s^2
        marker wall = [0, 0, 0] mm
        flexible bar {
            mesh = nastran(\"bar.bdf\", units: mm_tonne_s)
            support = foot
            modes = static(at: tip) + normal(2)
            damping = 70 %
            marker foot = patch(center: [0, 0, 0] mm, normal: z, radius: 15 mm, tie: rigid)
            marker tip = patch(center: [0, 0, 200] mm, normal: z, radius: 15 mm)
        }
        force load = Push(bar.tip, wall, x: push)
        output deflection: Length = dot(bar.tip.origin - wall.origin, wall.x)
        output slope: Angle = dot(bar.tip.z, wall.x)
        output reaction = bar.support.force in ground
    }
    analysis settle = transient(Held(), duration: 60 ms, sample: 10 ms)";

/// A load at the tip: deflection and slope of a thick beam, the support carries load and weight.
#[test]
fn a_held_bar_bends_as_a_beam_and_its_support_carries_it() {
    let program = program(HELD);
    let outcome = program
        .analysis("settle")
        .expect("an analysis")
        .run(&mut |_| {})
        .expect("a run");
    let last = |path: &str| {
        let column = outcome
            .results
            .columns()
            .iter()
            .find(|c| c.path == path)
            .unwrap_or_else(|| panic!("no {path}"));
        *column.values.last().expect("a sample")
    };
    let force = 1000.0;
    let shear_modulus = YOUNG / (2.0 * (1.0 + POISSON));
    let factor = 10.0 * (1.0 + POISSON) / (12.0 + 11.0 * POISSON);
    let bending = force * LENGTH.powi(3) / (3.0 * YOUNG * second_moment());
    let shear = force * LENGTH / (factor * shear_modulus * area());
    // a rigid foot also keeps the root from contracting sideways, which a beam does not: some per cent over half a side
    let ratio = last("deflection") / (bending + shear);
    assert!(ratio > 0.965 && ratio < 1.0, "{ratio}");
    let slope = force * LENGTH * LENGTH / (2.0 * YOUNG * second_moment());
    let ratio = last("slope") / slope;
    assert!(ratio > 0.965 && ratio < 1.0, "{ratio}");
    let weight = 9.81 * DENSITY * area() * LENGTH;
    assert!(
        (last("reaction.x") + force).abs() < 1e-3 * force,
        "{}",
        last("reaction.x")
    );
    assert!(
        (last("reaction.z") - weight).abs() < 1e-3 * weight,
        "{}",
        last("reaction.z")
    );
}

/// A support holds all nodes of its marker for every tie, unless averaging is stated. `support = deck` holds the
/// supports of the deck.
#[test]
fn supports_hold_their_nodes() {
    let frequencies = |support: &str, tie: &str, cards: &str| {
        let deck = include_str!("mesh/bar.bdf").replace("ENDDATA", &format!("{cards}ENDDATA"));
        let text = HELD
            .replace("support = foot", &format!("support = {support}"))
            .replace(", tie: rigid", tie);
        let program = program_of(&[("bar.eng", &text), ("bar.bdf", &deck)]);
        let model = program.model("Held").expect("a model");
        model.reductions()[0].frequencies().to_vec()
    };
    let rigid = frequencies("foot", ", tie: rigid", "");
    let near = |found: &[f64]| {
        let pairs = found.iter().zip(&rigid);
        pairs.map(|(x, y)| (x / y - 1.0).abs()).fold(0.0, f64::max)
    };
    assert!(near(&frequencies("foot", "", "")) < 1e-9);
    let nodes = "SPC1,1,123,1,THRU,4\nSPC1,1,123,9,THRU,12\n";
    assert!(near(&frequencies("deck", "", nodes)) < 1e-9);
    let mean = near(&frequencies("foot", ", tie: averaging", ""));
    assert!((0.005..0.2).contains(&mean), "{mean}");
}

/// Twice the load, twice the deflection: parameters change without compiling again.
#[test]
fn a_parameter_changes_the_load_on_a_compiled_flexible_model() {
    let model = program(HELD).model("Held").expect("a model");
    let (push, deflection) = (
        model.parameter("push").expect("a parameter"),
        model.channel("deflection").expect("a channel"),
    );
    let settled = |text: &str| {
        let load: Quantity = text.parse().expect("a quantity");
        let mut simulation = model
            .simulation()
            .set(push, load)
            .expect("a force")
            .start()
            .expect("a start");
        while simulation.time() < 0.06 {
            simulation.step().expect("a step");
        }
        simulation.value(deflection).expect("a value")
    };
    let (one, two) = (settled("500 N"), settled("1000 N"));
    assert!((two / one - 2.0).abs() < 1e-3, "{one} {two}");
}

/// The first line of `eng check` counts the rates of modes among the velocities.
#[test]
fn a_summary_counts_the_velocities_of_modes() {
    let summary = program(FREE).model("Free").expect("a model").summary();
    assert!(
        summary.starts_with("Free: 1 body with 13 velocities,"),
        "{summary}"
    );
}
