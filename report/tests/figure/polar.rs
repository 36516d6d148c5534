//! Polar diagrams.

use eng_report::figure::{FixedTo, Polar, PolarCurve, Upright};

#[test]
fn a_turning_vector_stands_still_in_the_journal() {
    let angle: Vec<f64> = (0..=360).map(f64::from).collect();
    let curve = PolarCurve {
        name: "main[1]".to_owned(),
        frame: "block.main[1]".to_owned(),
        x: angle
            .iter()
            .map(|a| 3.0 * libm::cos(a.to_radians()))
            .collect(),
        y: angle
            .iter()
            .map(|a| 3.0 * libm::sin(a.to_radians()))
            .collect(),
        angle: angle.clone(),
        last_cycle: 0,
    };
    let turned = curve.turned(&angle, "crank.main[1]");
    assert!(
        turned
            .x
            .iter()
            .zip(&turned.y)
            .all(|(x, y)| (x - 3.0).abs() < 1e-12 && y.abs() < 1e-12)
    );
    let figure = Polar {
        title: "Journal load".to_owned(),
        subtitle: String::new(),
        quantity: "F".to_owned(),
        unit: "kN".to_owned(),
        fixed_to: FixedTo::Housing,
        period: 720.0,
        upright: Upright::X,
        limit: Some((4.0, "allowed".to_owned())),
        curves: vec![curve],
    };
    let svg = figure.to_svg();
    assert!(svg.contains("fixed to the housing") && svg.contains("F ≤ 3 kN"));
    assert!(svg.contains("allowed") && svg.contains(">90°<") && !svg.contains("NaN"));
}
