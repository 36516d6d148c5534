//! Files of results: dimensions, replaced files, Parquet, streams, points of a resumed run, selections.

use eng::internals::results::{
    Stream, dimension_of, holds, matches, read_stream, remove_leftovers, resume_point_of,
};
use eng::results::{
    Column, KeptWarning, Last, Results, ResultsError, ResumePoint, Selection, file_stem,
    replace_file,
};
use eng::{Dimension, DisplayUnit};
use proptest::prelude::*;
use std::io::{self, Write};
use std::path::PathBuf;

proptest! {
    #[test]
    fn reads_what_display_prints(exponents in proptest::array::uniform8((-6i32..=6, 1usize..=4))) {
        let mut dimension = Dimension::ONE;
        for (base, (numerator, denominator)) in exponents.into_iter().enumerate() {
            if let Some(power) = Dimension::base(base).power(numerator, denominator as i32) {
                dimension = dimension.times(power);
            }
        }
        prop_assert_eq!(dimension_of(&dimension.to_string()), Some(dimension));
    }

    #[test]
    fn never_panics(text in "\\PC{0,12}") {
        let _ = dimension_of(&text);
    }
}

#[test]
fn refuses_other_texts() {
    for text in ["", "N", "m^", "m^x", "m*", "m^(1/0)", "m m", "m^2147483648"] {
        assert_eq!(dimension_of(text), None, "{text}");
    }
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("eng-results-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

#[test]
fn leftovers_of_one_path_are_removed() {
    let folder = folder("leftovers");
    std::fs::create_dir_all(&folder).unwrap();
    let names = [
        ".a.txt.12-0.part",
        ".a.txt.x.part",
        ".b.txt.12-0.part",
        "a.txt",
    ];
    for name in names {
        std::fs::write(folder.join(name), name).unwrap();
    }
    remove_leftovers(&folder.join("a.txt"));
    let left = names.map(|name| folder.join(name).exists());
    assert_eq!(left, [false, true, true, true]);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn keeps_the_old_content_when_writing_fails() {
    let folder = folder("keeps");
    let path = folder.join("a.txt");
    replace_file(&path, |f| f.write_all(b"old")).unwrap();
    let failed = replace_file(&path, |f| {
        f.write_all(b"ne")?;
        Err(io::Error::other("disk full"))
    });
    assert_eq!(failed.unwrap_err().to_string(), "disk full");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    replace_file(&path, |f| f.write_all(b"new")).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "new");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn stems_are_file_names() {
    assert_eq!(file_stem("sweep[3]"), "sweep[3]");
    assert_eq!(file_stem("a/b:c"), "a_b_c");
    assert_eq!(file_stem(".."), "analysis");
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_devices_refused() {
    use eng::internals::results::{open, refuse_link, target};
    use std::path::Path;
    let folder = std::env::temp_dir().join(format!("eng-links-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (file, link) = (folder.join("file"), folder.join("link"));
    std::fs::write(&file, "old").unwrap();
    std::os::unix::fs::symlink(&file, &link).unwrap();
    let put = |path: &Path| replace_file(path, |out| out.write_all(b"new"));
    put(&link).unwrap();
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(std::fs::read(&file).unwrap(), b"new");
    assert!(target(Path::new("/dev/null")).is_err());
    assert!(open(Path::new("/dev/null")).is_err());
    assert!(open(&link).is_ok());
    assert!(refuse_link(&link).is_err());
    assert!(refuse_link(&file).is_ok() && refuse_link(&folder.join("none")).is_ok());
    std::fs::remove_dir_all(&folder).unwrap();
}

fn sample() -> Results {
    let mut results = Results::new("sweep[3]", "Inline4");
    results.set_metadata("version", "0.1.0");
    results.set_metadata("parameter.speed", "4000 rpm");
    let times: Vec<f64> = (0..5000).map(|i| f64::from(i) * 1e-5).collect();
    results
        .push(Column::cycle_angle(
            times.iter().map(|t| t * 400.0).collect(),
        ))
        .unwrap();
    results
        .push(Column::cycle_speed(vec![400.0; 5000]))
        .unwrap();
    let force = Dimension::MASS
        .times(Dimension::LENGTH)
        .over(Dimension::TIME)
        .over(Dimension::TIME);
    results
        .push(Column {
            path: "main[5].force.x".to_owned(),
            dimension: force,
            display: DisplayUnit {
                symbol: "kN".to_owned(),
                scale: 1e3,
                offset: 0.0,
            },
            frame: "block.main[5]".to_owned(),
            values: times.iter().map(|t| 1.0e4 * libm::sin(400.0 * t)).collect(),
        })
        .unwrap();
    results
        .push(Column {
            path: "oil".to_owned(),
            dimension: Dimension::base(4),
            display: DisplayUnit {
                symbol: "degC".to_owned(),
                scale: 1.0,
                offset: 273.15,
            },
            frame: String::new(),
            values: times
                .iter()
                .map(|t| if *t == 0.0 { f64::NAN } else { 378.15 })
                .collect(),
        })
        .unwrap();
    results
}

#[test]
fn round_trip() {
    let folder = folder("round-trip");
    let written = sample();
    let path = written.write_parquet(&folder).unwrap();
    assert_eq!(path.file_name().unwrap(), "sweep[3].parquet");
    let read = Results::read_parquet(&path).unwrap();
    assert_eq!(read.analysis(), "sweep[3]");
    assert_eq!(read.model(), "Inline4");
    assert_eq!(read.metadata(), written.metadata());
    assert_eq!(read.samples(), 5000);
    for (a, b) in read.columns().iter().zip(written.columns()) {
        assert_eq!(
            (&a.path, a.dimension, &a.display, &a.frame),
            (&b.path, b.dimension, &b.display, &b.frame)
        );
        for (x, y) in a.values.iter().zip(&b.values) {
            assert!(
                (x.is_nan() && y.is_nan()) || (x - y).abs() <= 4e-16 * y.abs().max(300.0),
                "{x} {y}"
            );
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn same_results_same_bytes() {
    let (a, b) = (folder("bytes-a"), folder("bytes-b"));
    let first = std::fs::read(sample().write_parquet(&a).unwrap()).unwrap();
    let second = std::fs::read(sample().write_parquet(&b).unwrap()).unwrap();
    assert!(first == second);
    std::fs::remove_dir_all(&a).unwrap();
    std::fs::remove_dir_all(&b).unwrap();
}

#[test]
fn no_columns_and_foreign_files() {
    let folder = folder("foreign");
    let path = Results::new("empty", "M").write_parquet(&folder).unwrap();
    let read = Results::read_parquet(&path).unwrap();
    assert_eq!((read.samples(), read.columns().len()), (0, 0));
    let other = folder.join("other.parquet");
    let whole = std::fs::read(&path).unwrap();
    let mut inside = whole.clone();
    let footer = inside.len() - 8;
    inside[footer - 20..footer].fill(0xff);
    for (bytes, problem) in [
        (&b"PAR1 is not enough"[..], "the end of the file is missing"),
        (&whole[..whole.len() - 3], "the end of the file is missing"),
        (&inside, "the file is damaged inside"),
        (b"time,force\n0,1\n", "this is no Parquet file"),
        (b"PAR", "this is no Parquet file"),
        (b"", "the file is empty"),
    ] {
        std::fs::write(&other, bytes).unwrap();
        let refused = Results::read_parquet(&other).unwrap_err().to_string();
        assert!(refused.contains("other.parquet: "), "{refused}");
        assert!(refused.contains(problem), "{refused}");
        assert!(refused.ends_with("run the analysis again, or copy the file again"));
    }
    assert!(matches!(
        Results::read_parquet(&folder),
        Err(ResultsError::File { .. })
    ));
    assert!(matches!(
        Results::read_parquet(folder.join("none")),
        Err(ResultsError::File { .. })
    ));
    std::fs::remove_dir_all(&folder).unwrap();
}

/// A byte that has changed anywhere is refused or changes nothing that is read; an end that is missing is
/// refused.
#[test]
fn damaged_files_are_refused_or_read() {
    let folder = folder("damaged");
    let mut results = Results::new("a", "M");
    let times: Vec<f64> = (0..40).map(|i| f64::from(i) * 0.1).collect();
    results.push(Column::time(times.clone())).unwrap();
    results.push(Column::cycle_angle(times)).unwrap();
    let path = results.write_parquet(&folder).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let written = Results::read_parquet(&path).unwrap();
    let other = folder.join("other.parquet");
    let mut refused = 0;
    for index in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[index] ^= [0x01, 0x80, 0xff][index % 3];
        std::fs::write(&other, bytes).unwrap();
        match Results::read_parquet(&other) {
            Ok(read) => assert!(read == written, "{index}"),
            Err(error) => {
                assert!(error.to_string().contains("other.parquet"), "{error}");
                refused += 1;
            }
        }
        if index % 5 == 0 {
            std::fs::write(&other, &whole[..index]).unwrap();
            assert!(Results::read_parquet(&other).is_err(), "{index}");
        }
    }
    // nothing reads statistics of columns and the names of the library's own entries
    assert!(refused > whole.len() / 2, "{refused} of {}", whole.len());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn comes_back_and_notices_every_damage() {
    let folder = std::env::temp_dir().join(format!("eng-resume-{}", std::process::id()));
    let path = folder.join("a.checkpoint");
    assert_eq!(ResumePoint::read(&path).unwrap(), None);
    let point = ResumePoint {
        identity: "abc".to_owned(),
        samples: 17,
        warnings: vec![KeptWarning {
            path: "main[1]".to_owned(),
            used_at: Some((0, 5, 9)),
            defined_at: None,
            name: "thin".to_owned(),
            message: "film is thin".to_owned(),
            time: 0.1_f64.to_bits(),
            cycle_angle: Some(f64::to_bits(1.0)),
        }],
        state: (0..=255).collect(),
    };
    point.write(&path).unwrap();
    assert_eq!(ResumePoint::read(&path).unwrap().as_ref(), Some(&point));
    let bytes = std::fs::read(&path).unwrap();
    for index in 0..bytes.len() {
        let mut wrong = bytes.clone();
        wrong[index] ^= 1;
        assert_eq!(resume_point_of(&wrong), None, "byte {index}");
        assert_eq!(
            resume_point_of(&bytes[..index]),
            None,
            "first {index} bytes"
        );
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn patterns() {
    for (pattern, path, fits) in [
        ("main[*].force.*", "main[5].force.x", true),
        ("main[*].force.*", "main[5].eccentricity.x", false),
        ("main[?].force.x", "main[12].force.x", false),
        ("*", "", true),
        ("*.x", "a.x.b.x", true),
        ("*.x", "a.x.b", false),
        ("vertical[1]", "vertical[1]", true),
        ("", "a", false),
        ("a*b*c", "aXbYbc", true),
    ] {
        assert_eq!(matches(pattern, path), fits, "{pattern} {path}");
    }
}

#[test]
fn keeps_what_is_asked_and_the_axes() {
    let mut results = Results::new("a", "M");
    results.push(Column::time(vec![0.0])).unwrap();
    results.push(Column::cycle_angle(vec![0.0])).unwrap();
    for path in ["main[1].force.x", "main[1].film"] {
        let mut column = Column::time(vec![0.0]);
        column.path = path.to_owned();
        results.push(column).unwrap();
    }
    let selection = Selection::new(["*.force.*, *.nothing"]);
    assert!(matches!(
        selection.of(&results),
        Err(ResultsError::NoChannel { pattern, .. }) if pattern == "*.nothing"
    ));
    let kept = Selection::new(["*.force.*"]).apply(&results).unwrap();
    let paths: Vec<&str> = kept.columns().iter().map(|c| c.path.as_str()).collect();
    assert_eq!(paths, ["time", "cycle.angle", "main[1].force.x"]);
    assert_eq!(Selection::default().of(&results).unwrap(), [true; 4]);
}

#[test]
fn last_parts_are_angles_or_times() {
    assert_eq!(Last::new(0.1, Dimension::TIME).unwrap(), Last::Time(0.1));
    assert_eq!(Last::new(6.0, Dimension::ANGLE).unwrap(), Last::Angle(6.0));
    assert!(Last::new(0.0, Dimension::TIME).is_err());
    assert!(Last::new(f64::NAN, Dimension::TIME).is_err());
    assert!(Last::new(1.0, Dimension::LENGTH).is_err());
    // engines that turn backwards count too
    let turn = Last::Angle(1.0);
    assert!(holds(turn, -9.0, -10.0) && !holds(turn, -8.9, -10.0));
}

/// A byte that has changed anywhere, or an end that is missing, is refused or gives no more samples than
/// were written.
#[test]
fn damaged_streams_are_refused_or_read() {
    let folder = std::env::temp_dir().join(format!("eng-stream-{}", std::process::id()));
    let path = folder.join("a.partial.arrows");
    let mut header = Results::new("a", "M");
    header.push(Column::time(Vec::new())).unwrap();
    header.push(Column::cycle_angle(Vec::new())).unwrap();
    let mut stream = Stream::create(&path, &header).unwrap();
    for batch in 0..3 {
        let values = vec![f64::from(batch); 5];
        stream.write(&mut [values.clone(), values]).unwrap();
    }
    drop(stream);
    assert_eq!(read_stream(&path).unwrap().samples(), 15);
    let whole = std::fs::read(&path).unwrap();
    let other = folder.join("b.partial.arrows");
    for index in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[index] ^= [0x01, 0x80, 0xff][index % 3];
        std::fs::write(&other, bytes).unwrap();
        match read_stream(&other) {
            Ok(left) => assert!(left.samples() <= 15, "{index}"),
            Err(error) => assert!(error.to_string().contains("b.partial"), "{error}"),
        }
        std::fs::write(&other, &whole[..index]).unwrap();
        if let Ok(left) = read_stream(&other) {
            assert!(left.samples() <= 15, "{index}");
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
