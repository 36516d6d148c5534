//! Curves of one quantity over another one.

use eng_report::figure::{Ordinate, Xy, XyCurve};

fn loop_of_work() -> Xy {
    let angle: Vec<f64> = (0..=360).map(f64::from).collect();
    let axis = |quantity: &str, unit: &str| Ordinate {
        quantity: quantity.to_owned(),
        unit: unit.to_owned(),
        frame: String::new(),
    };
    Xy {
        title: "Indicator".to_owned(),
        subtitle: "Test".to_owned(),
        x: axis("Volume", "cm³"),
        y: axis("Pressure", "bar"),
        curves: vec![XyCurve {
            name: "gas".to_owned(),
            x: angle
                .iter()
                .map(|a| 300.0 + 200.0 * libm::cos(a.to_radians()))
                .collect(),
            y: angle
                .iter()
                .map(|a| 4.0 + 3.0 * libm::sin(a.to_radians()))
                .collect(),
            angle,
        }],
    }
}

#[test]
fn a_loop_returns_to_its_begin_and_keeps_its_angles() {
    let svg = Xy::to_svg(&loop_of_work());
    assert!(svg.contains("Volume (cm³)") && svg.contains("Pressure (bar)"));
    let (_, polyline) = svg.split_once("<polyline").unwrap();
    let (_, points) = polyline.split_once("points=\"").unwrap();
    let points: Vec<(f64, f64)> = points
        .split_once('"')
        .unwrap()
        .0
        .split(' ')
        .map(|point| {
            let (x, y) = point.split_once(',').unwrap();
            (x.parse().unwrap(), y.parse().unwrap())
        })
        .collect();
    assert_eq!(points.len(), 361);
    assert_eq!(points.first(), points.last());
    // a circle of the data is an ellipse of pixels: each point lies on it
    let middle = |low: f64, high: f64| (0.5 * (low + high), 0.5 * (high - low));
    let least = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).fold(f64::INFINITY, f64::min);
    let most = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).fold(0.0, f64::max);
    let (x, a) = middle(least(|p| p.0), most(|p| p.0));
    let (y, b) = middle(least(|p| p.1), most(|p| p.1));
    for point in &points {
        let off = libm::hypot((point.0 - x) / a, (point.1 - y) / b) - 1.0;
        assert!(off.abs() < 1e-3, "{point:?}: {off}");
    }
}

#[test]
fn gaps_and_nothing_are_drawn() {
    let mut figure = loop_of_work();
    figure.curves[0].y[100] = f64::NAN;
    let svg = figure.to_svg();
    assert_eq!(svg.matches("<polyline").count(), 2);
    assert!(!svg.contains("NaN"));
    figure.curves.clear();
    assert!(!figure.to_svg().contains("NaN"));
}
