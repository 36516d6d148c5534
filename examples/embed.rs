//! A Rust program that embeds a compiled model: compile a text, change a parameter, step, read outputs by handle.
//!
//! `cargo run --release --example embed`

use eng::{Quantity, Sources};

const PENDULUM: &str = r#"
use std.joints.Revolute

/// A rod that swings about a horizontal axis.
model Pendulum {
    param rod: Length = 1 m in (1 mm, 100 m)
    gravity = [0, -9.81, 0] m/s^2
    marker pivot = [0, 0, 0] mm
    body bob {
        mass = 1 kg
        inertia = [1, 1, 1] g*m^2
        marker top = [0, 1, 0]*rod
    }
    joint pin = Revolute(bob.top, pivot)
    start pin.angle = 20 deg
    output height = bob.origin.origin - pivot.origin in ground as mm
}
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sources = Sources::from_text("pendulum.eng", PENDULUM);
    let checked = eng::check(&sources, "pendulum.eng");
    let program = checked.into_program()?;
    let model: eng::Model = program.model("Pendulum")?;

    let rod = model.parameter("rod")?;
    let angle = model.channel("pin.angle")?;
    let pull = model.channel("pin.force.y")?;

    let mut simulation = model
        .simulation()
        .set(rod, "250 mm".parse::<Quantity>()?)?
        .fixed_step(1e-4)
        .start()?;
    println!("{:>8} {:>10} {:>10}", "t [s]", "angle [°]", "pull [N]");
    while simulation.time() < 1.0 {
        for _ in 0..500 {
            simulation.step()?;
        }
        println!(
            "{:8.3} {:10.4} {:10.4}",
            simulation.time(),
            simulation.value(angle)?.to_degrees(),
            simulation.value(pull)?,
        );
    }

    // a run from a checkpoint has the same bits
    let saved = simulation.checkpoint();
    simulation.step()?;
    let mut resumed = model
        .simulation()
        .set(rod, "250 mm".parse::<Quantity>()?)?
        .fixed_step(1e-4)
        .resume(&saved)?;
    resumed.step()?;
    assert_eq!(
        simulation.value(angle)?.to_bits(),
        resumed.value(angle)?.to_bits()
    );
    Ok(())
}
