//! Made-up results of a four-cylinder engine: waves and turning bars, so that no part of a report
//! is empty.

use eng_report::animation::{
    Animation, FilmSurface, Films, FlexibleBody, ModeShape, NodeField, Part, Pose, RigidBody,
    Surface, Up,
};
use eng_report::figure::{
    Abscissa, Campbell, Curve, FixedTo, History, Mark, Orbit, Orbits, Ordinate, Panel, Polar,
    PolarCurve, Scale, SweepFigure, Upright, Waterfall, journal_letter, spectra,
};
use eng_report::page::{
    Cell, Column, EnergyAudit, Mode, Page, Provenance, Section, Table, modes_table,
};
use eng_report::signal::{Level, Sampling, Signal, SpectrumOptions, Window, spectrum, sweep_map};

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Crank angle over two cycles (°).
fn angles() -> Vec<f64> {
    (0..=2880).map(|i| f64::from(i) * 0.5).collect()
}

/// Force on a journal (kN) at a crank angle.
fn force(journal: usize, angle: f64, fired: bool) -> f64 {
    let phase = journal as f64 * 0.4;
    let inertia = 9.0 * libm::cos(2.0 * angle * DEGREE + phase)
        + 2.0 * libm::sin(4.0 * angle * DEGREE - phase)
        + 0.3 * libm::sin(41.0 * angle * DEGREE);
    let mut gas = 0.0;
    if fired {
        for firing in 0..9 {
            let since = angle - 180.0 * f64::from(firing) - 12.0;
            let near = 1.0 / (1.0 + libm::fabs((firing + 4 - journal as i32) as f64 % 4.0));
            gas -= 28.0 * near * libm::exp(-since * since / 500.0);
        }
    }
    inertia + gas
}

fn forces(fired: bool) -> Vec<Curve> {
    (0..5)
        .map(|journal| Curve {
            name: format!("{} main[{}]", journal_letter(journal), journal + 1),
            values: angles()
                .iter()
                .map(|angle| force(journal, *angle, fired))
                .collect(),
        })
        .collect()
}

pub fn history() -> History {
    let first_cycle = angles().iter().take_while(|a| **a <= 720.0).count();
    let panel = |title: &str, fired| Panel {
        title: title.to_owned(),
        x: angles()[..first_cycle].to_vec(),
        curves: forces(fired)
            .into_iter()
            .map(|mut curve| {
                curve.values.truncate(first_cycle);
                curve
            })
            .collect(),
    };
    History {
        title: "Vertical force on the main journals".to_owned(),
        subtitle: "made-up four-cylinder engine, 4000 rpm, not filtered".to_owned(),
        abscissa: Abscissa::CrankAngle,
        ordinate: Ordinate {
            quantity: "Force x".to_owned(),
            unit: "kN".to_owned(),
            frame: "block".to_owned(),
        },
        scale: Scale::Linear,
        marks: [(1, 0.0), (3, 180.0), (4, 360.0), (2, 540.0)]
            .map(|(cylinder, angle)| Mark::firing_tdc(Some(cylinder), angle, 720.0))
            .to_vec(),
        panels: vec![panel("unfired", false), panel("fired", true)],
    }
}

pub fn spectrum_figure() -> History {
    let values: Vec<f64> = forces(true)[4].values[..2880].to_vec();
    let found = spectrum(
        Signal {
            values: &values,
            sampling: Sampling::Angle { step: 0.5 },
        },
        SpectrumOptions {
            window: Window::Hann,
            ..SpectrumOptions::default()
        },
    )
    .unwrap();
    spectra(
        "Spectrum of the vertical force at journal 5",
        "made-up engine, fired",
        Ordinate {
            quantity: "Force x, 0-peak".to_owned(),
            unit: "kN".to_owned(),
            frame: "block".to_owned(),
        },
        Scale::Logarithmic,
        Some(60.0),
        &[("E main[5]".to_owned(), &found)],
    )
}

fn paths(scale: f64) -> Vec<(Vec<f64>, Vec<f64>)> {
    (0..5)
        .map(|journal| {
            let phase = f64::from(journal) * 0.4;
            angles()
                .iter()
                .map(|a| {
                    let r = 0.7 + 0.2 * libm::sin(a * DEGREE + phase);
                    let turn = 2.0 * a * DEGREE + phase;
                    (
                        scale * r * libm::cos(turn),
                        0.8 * scale * r * libm::sin(turn),
                    )
                })
                .unzip()
        })
        .collect()
}

pub fn orbits() -> Orbits {
    Orbits {
        title: "Orbits of the pins in their shells".to_owned(),
        subtitle: "made-up engine, fired, 4000 rpm".to_owned(),
        period: 720.0,
        upright: Upright::X,
        orbits: paths(27e-6)
            .into_iter()
            .enumerate()
            .map(|(journal, (x, y))| Orbit {
                name: format!("{} main[{}]", journal_letter(journal), journal + 1),
                frame: format!("block.main[{}]", journal + 1),
                clearance: 27e-6,
                x,
                y,
                angle: angles(),
                last_cycle: 0,
            })
            .collect(),
    }
}

pub fn polar(fixed_to: FixedTo) -> Polar {
    let curves = paths(30.0)
        .into_iter()
        .take(2)
        .enumerate()
        .map(|(journal, (x, y))| {
            let curve = PolarCurve {
                name: format!("{} main[{}]", journal_letter(journal), journal + 1),
                frame: format!("block.main[{}]", journal + 1),
                x,
                y,
                angle: angles(),
                last_cycle: 0,
            };
            match fixed_to {
                FixedTo::Housing => curve,
                FixedTo::Journal => curve.turned(&angles(), format!("crank.main[{}]", journal + 1)),
            }
        })
        .collect();
    Polar {
        title: "Journal load".to_owned(),
        subtitle: "made-up engine, fired, 4000 rpm".to_owned(),
        quantity: "F".to_owned(),
        unit: "kN".to_owned(),
        fixed_to,
        period: 720.0,
        upright: Upright::X,
        limit: Some((32.0, "allowed load".to_owned())),
        curves,
    }
}

pub fn sweep(levels: bool) -> SweepFigure {
    let runs: Vec<_> = (0..26)
        .map(|index| {
            let speed = 1000.0 + 200.0 * f64::from(index);
            let step = 1.0 / 5000.0;
            let values: Vec<f64> = (0..4000)
                .map(|n| {
                    let t = f64::from(n) * step;
                    let at = |frequency: f64| libm::sin(std::f64::consts::TAU * frequency * t);
                    // a resonance at 620 Hz that orders excite in passing
                    [2.0, 4.0, 6.0, 8.0, 10.0, 12.0]
                        .iter()
                        .map(|order| {
                            let frequency = order * speed / 60.0;
                            let off = (frequency - 620.0) / 25.0;
                            (1.0 + 9.0 / (1.0 + off * off)) * at(frequency) / order
                        })
                        .sum()
                })
                .collect();
            let signal = Signal {
                values: &values,
                sampling: Sampling::Time { step },
            };
            (speed, spectrum(signal, SpectrumOptions::default()).unwrap())
        })
        .collect();
    let subtitle = format!("made-up engine; {}", runs[0].1.description());
    let mut map = sweep_map(&runs).unwrap();
    let level = Level::new(1e-3, "m/s²").unwrap();
    if levels {
        map.replace(|value| level.of(value).max(0.0));
    }
    SweepFigure {
        title: "Acceleration of journal 5 over speed".to_owned(),
        subtitle,
        quantity: "Acceleration x".to_owned(),
        unit: if levels {
            level.label()
        } else {
            "m/s²".to_owned()
        },
        frame: "block.main[5]".to_owned(),
        map,
        limit: Some(1200.0),
    }
}

pub fn campbell() -> Campbell {
    Campbell {
        figure: sweep(true),
        orders: vec![2.0, 4.0, 6.0, 8.0, 10.0, 12.0],
        natural_frequencies: vec![("first bending".to_owned(), 620.0)],
        modes: vec![(2000.0, 310.0), (3000.0, 340.0)],
    }
}

pub fn waterfall() -> Waterfall {
    Waterfall {
        figure: sweep(false),
    }
}

/// A round bar along z, closed at its ends.
fn bar(length: f64, radius: f64) -> Surface {
    let (rings, sides) = (40u32, 20u32);
    let mut surface = Surface::default();
    for ring in 0..=rings {
        let z = length * (f64::from(ring) / f64::from(rings) - 0.5);
        // journals and webs
        let radius = radius * if ring % 8 < 4 { 1.0 } else { 1.7 };
        for side in 0..sides {
            let angle = std::f64::consts::TAU * f64::from(side) / f64::from(sides);
            surface
                .nodes
                .push([radius * libm::cos(angle), radius * libm::sin(angle), z]);
        }
    }
    for ring in 0..rings {
        for side in 0..sides {
            let next = (side + 1) % sides;
            let (a, b) = (ring * sides + side, ring * sides + next);
            surface.triangles.push([a, b, b + sides]);
            surface.triangles.push([a, b + sides, a + sides]);
        }
    }
    surface
}

fn shape(surface: &Surface, name: &str, at: impl Fn([f64; 3]) -> [f64; 3]) -> ModeShape {
    ModeShape {
        name: name.to_owned(),
        displacements: surface.nodes.iter().map(|node| at(*node)).collect(),
    }
}

pub fn animation() -> Animation {
    let frames = 73;
    let angle = |frame: usize| frame as f64 * 10.0;
    let turn = |frame: usize| Pose {
        position: [0.0; 3],
        rotation: {
            let half = angle(frame) * DEGREE / 2.0;
            [libm::cos(half), 0.0, 0.0, libm::sin(half)]
        },
    };
    let crank = bar(0.5, 0.03);
    let bend = |z: f64| libm::cos(std::f64::consts::PI * z / 0.5);
    let shapes = vec![
        shape(&crank, "bending x", |p| [bend(p[2]), 0.0, 0.0]),
        shape(&crank, "bending y", |p| [0.0, bend(p[2]), 0.0]),
        shape(&crank, "torsion", |p| {
            [-p[1] * p[2] * 60.0, p[0] * p[2] * 60.0, 0.0]
        }),
    ];
    let field = NodeField {
        name: "von Mises, largest over the cycle".to_owned(),
        unit: "MPa".to_owned(),
        values: crank
            .nodes
            .iter()
            .map(|p| 40.0 + 300.0 * bend(p[2]))
            .collect(),
    };
    let crank = FlexibleBody {
        name: "crank".to_owned(),
        surface: crank,
        shapes,
        poses: (0..frames).map(turn).collect(),
        amplitudes: (0..frames)
            .map(|frame| {
                let a = angle(frame) * DEGREE;
                [
                    30e-6 * libm::cos(2.0 * a),
                    20e-6 * libm::sin(2.0 * a),
                    10e-6 * libm::sin(4.0 * a),
                ]
                .to_vec()
            })
            .collect(),
        fields: vec![field],
    };
    let pin = |frame: usize| {
        let a = angle(frame) * DEGREE;
        [0.045 * libm::cos(a), 0.045 * libm::sin(a)]
    };
    let piston = |frame: usize| {
        let [x, y] = pin(frame);
        x + (0.14f64 * 0.14 - y * y).sqrt()
    };
    let films = films(frames);
    Animation {
        title: "Crank & one piston".to_owned(),
        times: (0..frames)
            .map(|f| angle(f) / 360.0 * 60.0 / 4000.0)
            .collect(),
        angles: (0..frames).map(angle).collect(),
        up: Up::X,
        scale: 500.0,
        slowdown: 200.0,
        flexible: vec![crank],
        rigid: vec![
            RigidBody {
                name: "piston".to_owned(),
                parts: vec![Part::Cylinder {
                    from: [-0.02, 0.0, 0.0],
                    to: [0.04, 0.0, 0.0],
                    radius: 0.04,
                }],
                poses: (0..frames)
                    .map(|frame| Pose {
                        position: [piston(frame), 0.0, 0.0],
                        ..Pose::HOME
                    })
                    .collect(),
            },
            RigidBody {
                name: "rod".to_owned(),
                parts: vec![
                    Part::Box {
                        center: [0.07, 0.0, 0.0],
                        size: [0.14, 0.02, 0.015],
                    },
                    Part::Line {
                        points: vec![[0.0, 0.0, 0.03], [0.14, 0.0, 0.03]],
                    },
                ],
                poses: (0..frames)
                    .map(|frame| {
                        let [x, y] = pin(frame);
                        let half = libm::atan2(-y, piston(frame) - x) / 2.0;
                        Pose {
                            position: [x, y, 0.0],
                            rotation: [libm::cos(half), 0.0, 0.0, libm::sin(half)],
                        }
                    })
                    .collect(),
            },
            RigidBody {
                name: "block".to_owned(),
                parts: vec![Part::Box {
                    center: [-0.11, 0.0, 0.0],
                    size: [0.02, 0.2, 0.6],
                }],
                poses: vec![Pose::HOME],
            },
        ],
        films,
    }
}

/// A film on a sleeve at rest, whose pressure goes around with the crank; known at every sixth time.
fn films(frames: usize) -> Films {
    let (rings, sides) = (4u32, 36u32);
    let mut film = FilmSurface {
        name: "main[1]".to_owned(),
        surface: Surface::default(),
        outward: Vec::new(),
        poses: vec![Pose::HOME],
        moments: (0..frames).step_by(6).collect(),
        pressures: Vec::new(),
    };
    let place = |side: u32| std::f64::consts::TAU * f64::from(side) / f64::from(sides);
    for ring in 0..=rings {
        for side in 0..sides {
            let out = [libm::cos(place(side)), libm::sin(place(side)), 0.0];
            let z = 0.03 * (f64::from(ring) / f64::from(rings) - 0.5);
            film.surface.nodes.push([0.055 * out[0], 0.055 * out[1], z]);
            film.outward.push(out);
            if ring < rings {
                let (a, b) = (ring * sides + side, ring * sides + (side + 1) % sides);
                film.surface
                    .triangles
                    .extend([[a, b, b + sides], [a, b + sides, a + sides]]);
            }
        }
    }
    for moment in &film.moments {
        let angle = *moment as f64 * 10.0 * DEGREE;
        let at = |ring: u32, side: u32| {
            let across = 1.0 - (f64::from(ring) / f64::from(rings) - 0.5).abs() * 2.0;
            60.0 * across * libm::cos(place(side) - angle).max(0.0)
        };
        let all = (0..=rings).flat_map(|ring| (0..sides).map(move |side| (ring, side)));
        film.pressures
            .push(all.map(|(ring, side)| at(ring, side)).collect());
    }
    Films {
        surfaces: vec![film],
        unit: "MPa".to_owned(),
        height: 0.03,
    }
}

fn journals() -> Table {
    let row = |journal: usize| {
        let digits = |value, digits| Cell::Number { value, digits };
        let angle = |value| Cell::Fixed { value, decimals: 1 };
        let force = 36.0 - 2.0 * journal as f64;
        vec![
            journal_letter(journal).as_str().into(),
            Cell::Code(format!("main[{}]", journal + 1)),
            52.0.into(),
            19.0.into(),
            digits(27.0, 3),
            force.into(),
            angle(372.5),
            digits(force / (0.052 * 0.019) * 1e-3, 3),
            digits(1.1, 3),
            angle(391.0),
            digits(0.959, 3),
            Cell::number(118.0),
        ]
    };
    Table {
        caption: "Main journals".to_owned(),
        columns: vec![
            Column::new("Curve"),
            Column::new("Journal"),
            Column::with_unit("Diameter", "mm"),
            Column::with_unit("Width", "mm"),
            Column::with_unit("Radial clearance", "µm"),
            Column::with_unit("Largest force", "kN"),
            Column::with_unit("at", "°CA"),
            Column::with_unit("Specific load", "MPa").about("Force over the projected area."),
            Column::with_unit("Smallest film", "µm"),
            Column::with_unit("at", "°CA"),
            Column::with_unit("Largest ε", "1"),
            Column::with_unit("Friction", "W"),
        ],
        rows: (0..5).map(row).collect(),
    }
}

pub fn page() -> Page {
    let mode = |number, kind: &str, frequency| Mode {
        number,
        kind: kind.to_owned(),
        frequency,
        damping: Some(0.02),
        mass: Some(1.0),
        about: "block bends & twists".to_owned(),
    };
    let audit = EnergyAudit {
        work: vec![
            ("gas forces".to_owned(), 1510.2),
            ("drive".to_owned(), -1290.0),
        ],
        losses: vec![
            ("oil films".to_owned(), 182.1),
            ("modal damping".to_owned(), 38.0),
        ],
        stored: 0.1,
    };
    let provenance = Provenance {
        command: "eng report results --out report.html".to_owned(),
        versions: vec![("eng".to_owned(), "0.1.0".to_owned())],
        hashes: vec![(
            "engine.eng".to_owned(),
            format!("sha256:{}", "0123456789abcdef".repeat(4)),
        )],
        notes: vec![("tolerance".to_owned(), "1e-6".to_owned())],
    };
    Page::new("Made-up engine <4 cylinders>")
        .subtitle("analyses unfired and fired, 4000 rpm")
        .section(
            Section::new("Summary")
                .paragraph("Nothing here is a result: the page shows what a report looks like.")
                .facts([
                    ("Largest journal force", Cell::from("36.0 kN at 372.5 °CA")),
                    ("Smallest oil film", Cell::from("1.1 µm at 391 °CA")),
                    ("Energy residual", Cell::from("7·10⁻⁵")),
                ])
                .warning("main[3]: smallest oil film 1.1 µm at 391 °CA, below the 1.5 µm asked for."),
        )
        .section(Section::new("Modes").table(modes_table(
            "Modes of the block",
            &[
                mode(1, "static", None),
                mode(2, "normal", Some(412.3)),
                mode(3, "normal", Some(1650.0)),
            ],
        )))
        .section(
            Section::new("Journals")
                .table(journals())
                .figure(history(), "Vertical force on the main journals over a cycle, unfired above and fired below.")
                .figure(spectrum_figure(), "The second order leads.")
                .figure(orbits(), "Paths of the pins; the shells' x axis is up.")
                .figure(polar(FixedTo::Housing), "Load in the housing's axes.")
                .figure(polar(FixedTo::Journal), "The same load in the journal's axes.")
        )
        .section(
            Section::new("Run-up")
                .figure(waterfall(), "Spectra over speed.")
                .figure(campbell(), "Levels over speed with orders and the first bending mode."),
        )
        .section(Section::new("Motion").animation(animation()))
        .section(Section::new("Energy").table(audit.table("Energy over one cycle")))
        .section(
            Section::new("Provenance")
                .table(provenance.table("How this came to be"))
                .code("model Engine {\n  speed = 4000 rpm;\n}"),
        )
}
