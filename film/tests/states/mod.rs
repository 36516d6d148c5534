//! The reference states as films: units with R = c = μ = 1, so that tilt counts in slopes `2 tilt/B`.

use eng_film::{
    Cavitation, Feed, Film, FilmError, FilmSource, Inputs, Opening, Part, Summary, Work,
};
use serde_json::Value;

/// The file of reference numbers; its `source` and `conventions` state their origin.
pub fn reference() -> Value {
    serde_json::from_str(include_str!("../reference/film_reference.json"))
        .expect("the file is JSON")
}

pub fn number(value: &Value, key: &str) -> f64 {
    value[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} in {value}"))
}

pub fn pair(value: &Value, key: &str) -> [f64; 2] {
    [0, 1].map(|at| value[key][at].as_f64().unwrap_or(0.0))
}

/// Width, rule and openings of a state.
pub fn source(state: &Value, cells: [usize; 2]) -> FilmSource {
    let width = 2.0 * number(state, "width_over_diameter");
    let rule = match state["rule"].as_str() {
        Some("guembel") => Cavitation::Half,
        Some("jfo") => Cavitation::MassConserving,
        _ => Cavitation::Reynolds,
    };
    let mut source = FilmSource::plain(1.0, width, 1.0, rule, cells);
    for groove in state["grooves"].as_array().into_iter().flatten() {
        let edge = |at: usize| groove[at].as_f64().expect("an edge");
        source.openings.push(Opening {
            on: Part::Shell,
            around: [edge(0).to_radians(), edge(1).to_radians()],
            across: [edge(2) * width / 2.0, edge(3) * width / 2.0],
            feed: Feed::Pressure,
        });
    }
    if let Some(line) = state["zero_line_deg"].as_f64() {
        let angle = line.to_radians();
        source.openings.push(Opening {
            on: Part::Shell,
            around: [angle, angle],
            across: [-width, width],
            feed: Feed::Pressure,
        });
    }
    source
}

/// Inputs of a state of a film with this number of openings.
pub fn inputs(state: &Value, openings: usize) -> Vec<f64> {
    let slope = 1.0 / number(state, "width_over_diameter");
    let grooves = state["grooves"].as_array().map_or(0, Vec::len);
    let mut supply = vec![0.0; openings];
    supply[..grooves].fill(state["p_supply"].as_f64().unwrap_or(0.0));
    Inputs {
        eccentricity: pair(state, "eps"),
        rate: pair(state, "eps_rate"),
        tilt: pair(state, "tilt").map(|tilt| tilt * slope),
        tilt_rate: pair(state, "tilt_rate").map(|tilt| tilt * slope),
        spin: 2.0 * number(state, "mean_surface_speed"),
        end_pressure: state["p_ends"].as_f64().unwrap_or(0.0),
        supply: &supply,
        ..Inputs::still(1.0)
    }
    .write()
}

/// A solved film.
pub struct Solved {
    pub film: Film,
    pub work: Work,
    pub inputs: Vec<f64>,
    pub outputs: Vec<f64>,
    pub summary: Summary,
}

/// Solves a steady film without an earlier cavity.
pub fn solved(source: FilmSource, inputs: Vec<f64>) -> Result<Solved, FilmError> {
    let film = Film::new(source).expect("a film");
    let mut work = film.work();
    let mut outputs = vec![0.0; film.outputs()];
    film.solve(&inputs, None, &[], &mut work, &mut outputs)?;
    let summary = film.summary(&work);
    Ok(Solved {
        film,
        work,
        inputs,
        outputs,
        summary,
    })
}

/// Solves a state of the reference.
pub fn state(state: &Value, cells: [usize; 2]) -> Solved {
    let source = source(state, cells);
    let inputs = inputs(state, source.openings.len());
    solved(source, inputs).unwrap_or_else(|error| panic!("{}: {error}", state["id"]))
}
