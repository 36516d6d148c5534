//! Bars of changes.

use eng_report::figure::{Ordinate, Tornado, TornadoBar};

fn figure(bars: &[(&str, f64)]) -> Tornado {
    let bars = bars.iter().map(|(name, value)| TornadoBar {
        name: (*name).to_owned(),
        value: *value,
    });
    Tornado {
        title: "Influences".to_owned(),
        subtitle: "Test".to_owned(),
        abscissa: Ordinate {
            quantity: "Change of film".to_owned(),
            unit: "µm".to_owned(),
            frame: String::new(),
        },
        bars: bars.collect(),
    }
}

#[test]
fn bars_have_the_lengths_and_sides_of_their_changes() {
    let svg = figure(&[("clearance", -0.3), ("oil temperature", 0.15)]).to_svg();
    let bars: Vec<(f64, f64)> = svg
        .lines()
        .filter(|line| line.contains("height=\"22\""))
        .map(|line| {
            let number = |name: &str| -> f64 {
                let (_, rest) = line.split_once(&format!(" {name}=\"")).unwrap();
                rest.split_once('"').unwrap().0.parse().unwrap()
            };
            (number("x"), number("width"))
        })
        .collect();
    let [(left, long), (zero, short)] = bars.as_slice() else {
        panic!("{svg}");
    };
    assert!((left + long - zero).abs() < 0.02, "both begin at zero");
    assert!((long / short - 2.0).abs() < 1e-3);
    assert!(svg.contains(">−0.3<") && svg.contains(">0.15<") && svg.contains(">clearance<"));
    assert!(svg.contains("Change of film (µm)"));
}

#[test]
fn nothing_and_zero_are_drawn() {
    for bars in [&[][..], &[("a", 0.0)], &[("a", f64::NAN), ("b", 1e-9)]] {
        let svg = figure(bars).to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
