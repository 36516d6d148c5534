//! The table of the law `Reynolds`: its response against states of an independent solver, and points of the
//! shipped file made again.

use crate::states::{number, pair, reference};
use eng_film::impedance::{HEADER, childs_response, line, points, solved_response};

const FILE: &str = include_str!("../../stdlib/reynolds.csv");

#[test]
fn response_of_plain_aligned_films() {
    let (mut states, mut worst) = (0, 0.0_f64);
    for state in reference()["static"].as_array().expect("states") {
        let plain = state["zero_line_deg"].is_null()
            && state["grooves"].as_array().is_some_and(Vec::is_empty)
            && pair(state, "tilt") == [0.0; 2]
            && pair(state, "tilt_rate") == [0.0; 2];
        if !plain || state["rule"] != "reynolds" {
            continue;
        }
        states += 1;
        let (e, rate, half_spin) = (
            pair(state, "eps"),
            pair(state, "eps_rate"),
            number(state, "mean_surface_speed"),
        );
        let v = [rate[0] + half_spin * e[1], rate[1] - half_spin * e[0]];
        let (speed, ratio) = (v[0].hypot(v[1]), e[0].hypot(e[1]));
        let u = [v[0] / speed, v[1] / speed];
        let slenderness = number(state, "width_over_diameter");
        let force = [number(&state["value"], "fx"), number(&state["value"], "fy")];
        let over = -1.0 / (4.0 * slenderness * speed);
        let along = over * (force[0] * u[0] + force[1] * u[1]);
        let across = over * (force[1] * u[0] - force[0] * u[1]);
        // a mirrored film has the same response, except for the sign across
        let side = if e[1] * u[0] - e[0] * u[1] < 0.0 {
            -1.0
        } else {
            1.0
        };
        let cosine = (e[0] * u[0] + e[1] * u[1]) / ratio;
        let found = solved_response(slenderness, ratio, cosine).expect("a film");
        let error = (found[0] - along).hypot(found[1] - side * across) / along.hypot(across);
        worst = worst.max(error);
        assert!(error < 3e-4, "{}: {error:.1e}", state["id"]);
    }
    println!("response of {states} states: {worst:.1e}");
    assert_eq!(states, 27);
}

#[test]
fn points_of_the_file_are_made_again() {
    let mut lines = FILE.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let lines: Vec<&str> = lines.collect();
    let [slenderness, u, cosine] = points();
    assert_eq!(lines.len(), slenderness.len() * u.len() * cosine.len());
    // a stride without a common factor with the number of points visits all of them
    for at in (0..lines.len()).step_by(389) {
        let (row, column) = (at / cosine.len(), at % cosine.len());
        let made =
            line(slenderness[row / u.len()], u[row % u.len()], cosine[column]).expect("a film");
        let numbers = |line: &str| {
            line.split(',')
                .map(|n| n.parse().expect("a number"))
                .collect::<Vec<f64>>()
        };
        let (made, kept) = (numbers(&made), numbers(lines[at]));
        assert_eq!(made[..3], kept[..3], "line {}", at + 2);
        // the last digit of the file
        assert!(
            (made[3] - kept[3]).abs() < 1.5e-6 && (made[4] - kept[4]).abs() < 1.5e-5,
            "line {}",
            at + 2
        );
    }
}

#[test]
fn the_formula_is_an_isotropic_damper_at_the_centre() {
    let [along, across] = childs_response(0.0, 0.0, 0.5);
    let e = 1.0 + 2.12 * 4.0;
    assert!((along - 1.0 / (0.150 * e)).abs() < 1e-14 && across == 0.0);
    let [up, down] = [0.3, -0.3].map(|y| childs_response(0.2, y, 0.5));
    assert!((up[0] - down[0]).abs() < 1e-15 && (up[1] + down[1]).abs() < 1e-15);
}
