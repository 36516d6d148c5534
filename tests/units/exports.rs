//! Files for other programs: CSV, MATLAB, the universal format, descriptions of FMUs, PNG.

use eng::internals::fmu;
use eng::internals::results::{
    INT8, RESERVED, element, even_spacing, exponent, header, legal_names, number, vector,
};
use eng::plot::{PlotError, to_png};
use eng::results::{Column, CsvForm, Results, ResultsError};
use eng::{Dimension, DisplayUnit};
use resvg::tiny_skia::Pixmap;

#[test]
fn header_units_and_numbers() {
    let mut results = Results::new("unfired", "Inline4");
    results.push(Column::time(vec![0.0, 1e-6, 0.5])).unwrap();
    results
        .push(Column {
            path: "odd,\"name\"".to_owned(),
            dimension: Dimension::LENGTH,
            display: DisplayUnit {
                symbol: "mm".to_owned(),
                scale: 1e-3,
                offset: 0.0,
            },
            frame: String::new(),
            values: vec![-0.0, -1.0, f64::NAN],
        })
        .unwrap();
    let mut text = Vec::new();
    results.write_csv_to(&mut text, CsvForm::default()).unwrap();
    assert_eq!(
        String::from_utf8(text).unwrap(),
        "time,\"odd,\"\"name\"\"\"\r\ns,mm\r\n0,0\r\n1e-6,-1000\r\n0.5,NaN\r\n"
    );
}

#[test]
fn decimal_commas_and_other_separators() {
    let mut results = Results::new("unfired", "Inline4");
    results.push(Column::time(vec![0.5, 1e-6, -2.0])).unwrap();
    results.push(Column::cycle_angle(vec![0.0; 3])).unwrap();
    let mut text = Vec::new();
    let form = CsvForm::new(';', ',').unwrap();
    results.write_csv_to(&mut text, form).unwrap();
    assert_eq!(
        String::from_utf8(text).unwrap(),
        "time;cycle.angle\r\ns;deg\r\n0,5;0\r\n1e-6;0\r\n-2;0\r\n"
    );
    for (separator, decimal) in [(',', ','), ('x', '.'), (';', ';')] {
        assert!(CsvForm::new(separator, decimal).is_err());
    }
}

#[test]
fn numbers_read_back_to_the_same_bits() {
    for value in [0.1 + 0.2, -1.0 / 3.0, 1e-300, 6.02e23, f64::MAX, 5e-324] {
        assert_eq!(
            number(value).parse::<f64>().unwrap().to_bits(),
            value.to_bits()
        );
    }
}

#[test]
fn names_are_legal_and_differ() {
    let long = "a".repeat(80);
    let paths = [
        "main[5].force.x",
        "main_5.force.x",
        "units",
        "2nd",
        "",
        &long,
        &long,
    ];
    let names = legal_names(paths.into_iter(), &RESERVED);
    assert_eq!(
        names[..5],
        ["main_5_force_x", "main_5_force_x_2", "units_2", "x2nd", "x"]
    );
    assert_eq!((names[5].len(), names[6].len()), (63, 63));
    assert_ne!(names[5], names[6]);
}

#[test]
fn elements_are_padded_and_sized() {
    assert_eq!(element(INT8, b"abc"), b"\x01\0\0\0\x03\0\0\0abc\0\0\0\0\0");
    let bytes = vector("v", &[1.0, 2.0]);
    let size = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]);
    assert_eq!(size as usize + 8, bytes.len());
    assert_eq!(header().len(), 128);
}

#[test]
fn numbers_have_two_digits_of_exponent_and_their_width() {
    assert_eq!(exponent(0.0015, 13, 5), "  1.50000e-03");
    assert_eq!(exponent(-1e120, 20, 12), "-1.000000000000e+120");
    assert_eq!(exponent(0.0, 13, 5), "  0.00000e+00");
}

#[test]
fn spacing_is_even_only_if_six_digits_say_so() {
    let even: Vec<f64> = (0..1000).map(|i| f64::from(i) * 1e-5).collect();
    assert_eq!(even_spacing(&even), Some(1e-5));
    let third: Vec<f64> = (0..2000).map(|i| f64::from(i) / 3e5).collect();
    assert_eq!(even_spacing(&third), None);
    assert_eq!(even_spacing(&[0.0, 1.0, 3.0]), None);
    assert_eq!(even_spacing(&[0.0]), None);
}

#[test]
fn a_file_without_time_is_refused() {
    let path = std::env::temp_dir().join(format!("eng-no-time-{}.uff", std::process::id()));
    let mut results = Results::new("sweep", "M");
    results.push(Column::cycle_angle(vec![1.0])).unwrap();
    assert!(matches!(
        results.write_universal(&path),
        Err(ResultsError::Format { .. })
    ));
    assert!(!path.exists());
}

#[test]
fn structured_paths() {
    for (path, is) in [
        ("main[5].force.x", true),
        ("speed", true),
        ("a[1,2].b", true),
        ("a[i]", false),
        ("a[]", false),
        ("a b", false),
        ("größe", false),
        ("1a", false),
        ("", false),
    ] {
        assert_eq!(fmu::is_structured(path), is, "{path}");
    }
}

#[test]
fn numbers_keep_their_bits() {
    for value in [0.1, 1e-300, f64::MAX, -0.0, 5e-324, 1.0 / 3.0] {
        let read: f64 = fmu::number(value).parse().expect("a number");
        assert_eq!(read.to_bits(), value.to_bits());
    }
}

/// Draws a text and counts the pixels that are not white.
fn dark_pixels(text: &str) -> usize {
    let svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"40\" font-family=\"{}\"><rect width=\"200\" height=\"40\" fill=\"#ffffff\"/><text x=\"5\" y=\"28\" font-size=\"20\">{text}</text></svg>",
        eng_report::figure::FONT_FAMILY
    );
    let png = to_png(&svg, 1.0).unwrap();
    let image = Pixmap::decode_png(&png).unwrap();
    assert_eq!((image.width(), image.height()), (200, 40));
    image.pixels().iter().filter(|p| p.red() < 128).count()
}

#[test]
fn text_is_drawn_with_the_embedded_font() {
    assert_eq!(dark_pixels(""), 0);
    assert!(dark_pixels("Kraft 12 µm °CA ε −3") > 300);
}

#[test]
fn refuses_what_is_no_picture() {
    assert!(matches!(to_png("<svg", 1.0), Err(PlotError::Svg(_))));
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"10\" height=\"10\"/>";
    assert!(matches!(to_png(svg, 0.0), Err(PlotError::Size { .. })));
}

#[test]
fn figures_without_data_are_drawn() {
    let history = eng_report::figure::History {
        title: "Nothing".to_owned(),
        subtitle: String::new(),
        abscissa: eng_report::figure::Abscissa::Time,
        ordinate: eng_report::figure::Ordinate {
            quantity: "Force".to_owned(),
            unit: "N".to_owned(),
            frame: String::new(),
        },
        scale: eng_report::figure::Scale::Linear,
        marks: Vec::new(),
        panels: Vec::new(),
    };
    let image = Pixmap::decode_png(&to_png(&history.to_svg(), 0.5).unwrap()).unwrap();
    assert_eq!(image.width(), 600);
}
