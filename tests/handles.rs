//! Handles of parameters and channels are of the model that gave them.

use eng::{Error, Model, Sources};

fn model(text: &str, name: &str) -> Model {
    eng::check(&Sources::from_text("a.eng", text), "a.eng")
        .into_program()
        .unwrap_or_else(|report| panic!("{report}"))
        .model(name)
        .unwrap_or_else(|error| panic!("{error}"))
}

const FALL: &str = "
model Fall { gravity = [0, -9.81, 0] m/s^2; param load: Mass = 1 kg
    body bob { mass = load; inertia = [1, 1, 1] g*m^2 }
    output height = dot(bob.origin.origin, ground.y) as mm }
model Other { gravity = [0, -9.81, 0] m/s^2; param mass_of_bob: Mass = 1 kg
    body bob { mass = mass_of_bob; inertia = [1, 1, 1] g*m^2 }
    output height = dot(bob.origin.velocity, ground.y) as m/s }";

#[test]
fn a_handle_of_another_model_is_refused() {
    let (fall, other) = (model(FALL, "Fall"), model(FALL, "Other"));
    let load = fall.parameter("load").expect("a parameter");
    let height = fall.channel("height").expect("a channel");
    let refused = other
        .simulation()
        .set(load, "2 kg".parse().expect("a mass"));
    assert!(matches!(refused, Err(Error::OtherModel)));
    let mut simulation = other.simulation().start().expect("a start");
    let refused = simulation.value(height);
    assert!(matches!(refused, Err(Error::OtherModel)), "{refused:?}");
}

#[test]
fn a_handle_serves_the_same_model_compiled_again() {
    let (first, again) = (model(FALL, "Fall"), model(FALL, "Fall"));
    let load = first.parameter("load").expect("a parameter");
    let height = first.channel("height").expect("a channel");
    let mut simulation = again
        .simulation()
        .set(load, "2 kg".parse().expect("a mass"))
        .and_then(eng::SimulationBuilder::start)
        .expect("a start");
    assert_eq!(simulation.value(height).expect("a value"), 0.0);
}

/// A rise of temperature in degC would be 273 K too much.
#[test]
fn a_difference_is_not_set_in_a_unit_with_a_zero_of_its_own() {
    let text = "
model Warm { gravity = [0, 0, 0] m/s^2
    param rise: TemperatureDifference = 20 K
    param oil: Temperature = 350 K
    param ambient = 20 degC
    param boost: GaugePressure = 1 bar
    param manifold: AbsolutePressure = 1 bar
    body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2 }
    output shown = [oil + rise - ambient, 0 K]
    output pressure = manifold + boost as bar }";
    let warm = model(text, "Warm");
    let set = |path: &str, value: &str| {
        let parameter = warm.parameter(path).expect("a parameter");
        let value = value.parse().expect("a quantity");
        match warm.simulation().set(parameter, value) {
            Ok(_) => Ok(()),
            Err(error) => Err(error.to_string()),
        }
    };
    for (path, value) in [
        ("rise", "20 K"),
        ("oil", "80 degC"),
        ("oil", "350 K"),
        ("ambient", "30 degC"),
        ("boost", "2 bar"),
        ("manifold", "1 barg"),
    ] {
        assert_eq!(set(path, value), Ok(()), "{path} = {value}");
    }
    assert_eq!(
        set("rise", "20 degC"),
        Err(
            "rise is a difference, and the value counts from the zero of its unit: write it in K"
                .to_owned()
        )
    );
    assert!(set("boost", "1 barg").is_err());
}
