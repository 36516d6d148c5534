//! Figures are drawn for any data, and their files can be read.

use eng_report::figure::{
    Abscissa, Campbell, Curve, Figure, FixedTo, History, Mark, Orbit, Orbits, Ordinate, Panel,
    Polar, PolarCurve, Scale, SweepFigure, Upright, Waterfall,
};
use eng_report::page::{Page, Section};
use eng_report::signal::{Axis, Interpolation, SweepMap, difference, harmonics, maximum_at};
use proptest::prelude::*;
use proptest::test_runner::FileFailurePersistence;

fn numbers() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(
        prop_oneof![
            4 => -1e3f64..1e3,
            1 => proptest::num::f64::ANY,
            1 => Just(0.0),
        ],
        0..40,
    )
}

/// Every element is closed, and every number is finite.
fn check(svg: &str) -> Result<(), TestCaseError> {
    let mut open: Vec<&str> = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, _) = tag
            .split_once('>')
            .ok_or_else(|| TestCaseError::fail("no end"))?;
        if let Some(name) = tag.strip_prefix('/') {
            prop_assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.extend(tag.split_whitespace().next());
        }
    }
    prop_assert!(open.is_empty());
    for attribute in [
        "points",
        "d",
        "x",
        "y",
        "cx",
        "cy",
        "r",
        "width",
        "height",
        "transform",
    ] {
        for value in svg.split(&format!(" {attribute}=\"")).skip(1) {
            let value = value.split('"').next().unwrap_or_default();
            prop_assert!(
                !value.contains("NaN") && !value.contains("inf"),
                "{}",
                value
            );
        }
    }
    Ok(())
}

fn drawn(figure: impl Into<Figure>) -> Result<(), TestCaseError> {
    let figure = figure.into();
    check(&figure.to_svg())?;
    let page = Page::new("Any").section(Section::new("Figure").figure(figure, ""));
    let text = page
        .to_html()
        .map_err(|e| TestCaseError::fail(e.to_string()))?;
    let start = text.find("<svg").unwrap_or(0);
    let end = text.find("</svg>").map_or(text.len(), |end| end + 6);
    check(&text[start..end])
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 64,
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn histories(x in numbers(), y in numbers(), log in any::<bool>(), name in ".*", at in any::<f64>(), period in any::<f64>()) {
        drawn(History {
            title: name.clone(),
            subtitle: name.clone(),
            abscissa: Abscissa::CrankAngle,
            ordinate: Ordinate { quantity: name.clone(), unit: "N".to_owned(), frame: name.clone() },
            scale: if log { Scale::Logarithmic } else { Scale::Linear },
            marks: vec![Mark { at, label: name.clone(), period: Some(period), meaning: name.clone() }],
            panels: vec![Panel { title: name.clone(), x, curves: vec![Curve { name, values: y }] }],
        })?;
    }

    #[test]
    fn orbits_and_polar_diagrams(x in numbers(), y in numbers(), angle in numbers(), last_cycle in 0..10usize, size in any::<f64>(), name in ".*") {
        drawn(Orbits {
            title: name.clone(),
            subtitle: String::new(),
            period: size,
            upright: Upright::X,
            orbits: vec![Orbit {
                name: name.clone(),
                frame: name.clone(),
                clearance: size,
                x: x.clone(),
                y: y.clone(),
                angle: angle.clone(),
                last_cycle,
            }],
        })?;
        let curve = PolarCurve { name: name.clone(), frame: name.clone(), x, y, angle: angle.clone(), last_cycle };
        let turned = curve.turned(&angle, "pin");
        drawn(Polar {
            title: name.clone(),
            subtitle: String::new(),
            quantity: name.clone(),
            unit: "kN".to_owned(),
            fixed_to: FixedTo::Journal,
            period: 720.0,
            upright: Upright::Y,
            limit: Some((size, name)),
            curves: vec![curve, turned],
        })?;
    }

    #[test]
    fn maps(speeds in numbers(), step in any::<f64>(), row in numbers(), orders in numbers(), limit in any::<f64>()) {
        let mut speeds = speeds;
        speeds.retain(|speed| speed.is_finite());
        speeds.sort_by(f64::total_cmp);
        speeds.dedup();
        let rows = vec![row; speeds.len()];
        // without a positive step there is no map
        let Ok(map) = SweepMap::new(Axis::Frequency, speeds, step.abs(), rows) else {
            return Ok(());
        };
        let figure = SweepFigure {
            title: String::new(),
            subtitle: String::new(),
            quantity: String::new(),
            unit: String::new(),
            frame: String::new(),
            map,
            limit: Some(limit),
        };
        drawn(Waterfall { figure: figure.clone() })?;
        let modes = orders.iter().map(|o| (*o, *o)).collect();
        drawn(Campbell { figure, natural_frequencies: orders.iter().map(|o| (String::new(), *o)).collect(), modes, orders })?;
    }

    #[test]
    fn signals_answer_or_say_why_not(x in numbers(), y in numbers(), step in any::<f64>()) {
        // none of these may panic; a result must be a number
        if let Ok(found) = maximum_at(&x, &y) {
            prop_assert!(found.position.is_finite());
        }
        let _ = difference((&x, &y), (&y, &x), Interpolation::Cubic);
        let _ = harmonics(&y, step, 3);
    }
}
