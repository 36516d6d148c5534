//! Curves over time, angle, frequency and order.

use eng_report::figure::{Abscissa, Curve, History, Mark, Ordinate, Panel, Scale, journal_letter};

fn small() -> History {
    History {
        title: "Force on the pin".to_owned(),
        subtitle: "Slider, test".to_owned(),
        abscissa: Abscissa::CrankAngle,
        ordinate: Ordinate {
            quantity: "Force x".to_owned(),
            unit: "N".to_owned(),
            frame: "ground".to_owned(),
        },
        scale: Scale::Linear,
        marks: Vec::new(),
        panels: vec![Panel {
            title: String::new(),
            x: vec![0.0, 180.0, 360.0],
            curves: vec![
                Curve {
                    name: "a<1>".to_owned(),
                    values: vec![0.0, 2.5e6, -1.0e6],
                },
                Curve {
                    name: "b".to_owned(),
                    values: vec![1.0e6, f64::NAN, 1.0e6],
                },
            ],
        }],
    }
}

#[test]
fn small_figure() {
    insta::assert_snapshot!(small().to_svg());
}

#[test]
fn same_data_same_text() {
    assert_eq!(small().to_svg(), small().to_svg());
}

#[test]
fn empty_and_constant_data_are_drawn() {
    let mut figure = small();
    figure.panels[0].curves[0].values = vec![3.0; 3];
    assert!(figure.to_svg().contains("<polyline"));
    figure.panels.clear();
    let svg = figure.to_svg();
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn frequencies_stand_above_their_orders() {
    let mut figure = small();
    figure.abscissa = Abscissa::OrderAt { speed: 50.0 };
    figure.panels[0].x = vec![0.0, 5.0, 10.0];
    let svg = figure.to_svg();
    assert!(svg.contains("Frequency (Hz) at 3000 rpm") && svg.contains(">500</text>"));
    let left = |text: &str| {
        let (before, _) = svg.split_once(&format!(">{text}</text>"))?;
        let (_, tag) = before.rsplit_once("<text x=\"")?;
        tag.split_once('"')?.0.parse::<f64>().ok()
    };
    // 250 Hz are the fifth order of 3000 rpm
    assert!(left("250").is_some() && left("250") == left("5"), "{svg}");
    figure.abscissa = Abscissa::FrequencyAt { speed: 0.5 };
    assert!(
        figure
            .to_svg()
            .contains("Order (cycles a revolution) at 30 rpm")
    );
    figure.abscissa = Abscissa::OrderAt { speed: f64::NAN };
    assert!(!figure.to_svg().contains("NaN"));
}

#[test]
fn two_panels_share_the_axes() {
    let mut figure = small();
    figure.panels.push(figure.panels[0].clone());
    figure.panels[1].curves[0].values = vec![0.0, 9.0e6, 0.0];
    let svg = figure.to_svg();
    assert_eq!(svg.matches(">10<").count(), 2, "both reach 10·10⁶ N");
    assert_eq!(svg.matches(">a&lt;1&gt;<").count(), 1, "one legend");
}

#[test]
fn firing_marks_stand_again_every_cycle() {
    let mut figure = small();
    figure.panels[0].x = vec![0.0, 700.0, 1440.0];
    figure.marks = vec![
        Mark::firing_tdc(Some(1), 0.0, 720.0),
        Mark::firing_tdc(Some(3), 180.0, 720.0),
    ];
    let svg = figure.to_svg();
    assert_eq!(svg.matches(">TDC 1<").count(), 3, "0, 720 and 1440");
    assert_eq!(svg.matches(">TDC 3<").count(), 2, "180 and 900");
}

#[test]
fn a_shaft_that_turns_backwards_has_the_same_curve() {
    let mut figure = small();
    figure.panels[0].curves.truncate(1);
    let forwards = figure.to_svg();
    figure.panels[0].x.reverse();
    for curve in &mut figure.panels[0].curves {
        curve.values.reverse();
    }
    assert_eq!(figure.to_svg(), forwards);
}

#[test]
fn a_logarithmic_axis_has_powers_of_ten() {
    let mut figure = small();
    figure.scale = Scale::Logarithmic;
    figure.panels[0].curves[0].values = vec![1e-9, 30.0, 2000.0];
    let svg = figure.to_svg();
    assert!(svg.contains(">10⁶<") && svg.contains(">10⁰<") && !svg.contains(">10⁻¹<"));
    assert!(!svg.contains("NaN"));
}

#[test]
fn journals_have_letters() {
    assert_eq!([0, 4, 26].map(journal_letter), ["A", "E", "A1"]);
}
