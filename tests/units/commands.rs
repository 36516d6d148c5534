//! Parts of the command line.

use eng::Progress;
use eng::internals::cli::{
    Bars, claim_from, place, progress_bar, rounded, setting, show_progress, versions,
};
use indicatif::ProgressBar;
use std::path::Path;

#[test]
fn settings_have_path_and_value() {
    let read = setting("cylinder[2].bore = 86 mm").unwrap();
    assert_eq!(
        (read.path.as_str(), read.value.as_str()),
        ("cylinder[2].bore", "86 mm")
    );
    for text in ["speed", "=3", "speed=", ""] {
        assert!(setting(text).is_err(), "{text}");
    }
}

#[test]
fn a_library_is_known_by_its_mark() {
    let library = b"\x7fELF eng-library-version=\0=\xff eng-library-version=0.2.0\0more=";
    assert_eq!(versions(library), ["", "0.2.0"]);
    assert_eq!(versions(b"eng-library-version=0.1.0\n"), ["0.1.0"]);
    let others: [&[u8]; 3] = [b"", b"root:x:0:0", b"eng-library-version=0.1.0"];
    for other in others {
        assert!(versions(other).is_empty(), "{other:?}");
    }
}

#[test]
fn results_of_another_text_are_not_replaced() {
    let here = std::env::temp_dir().join(format!("eng-claim-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&here);
    let folder = Path::new("results/x");
    for place in ["a", "b", "results/x"] {
        std::fs::create_dir_all(here.join(place)).unwrap();
    }
    let (first, second) = (Path::new("a/x.eng"), Path::new("b/x.eng"));
    for text in [first, second] {
        std::fs::write(here.join(text), "").unwrap();
    }
    let claim = |text: &Path| claim_from(&here, text, folder);
    assert_eq!(claim(first), Ok(()));
    // no results yet
    assert_eq!(claim(second), Ok(()));
    std::fs::write(here.join("results/x/run.parquet"), "").unwrap();
    assert_eq!(claim(second), Ok(()));
    let refused = claim(first).unwrap_err();
    let told = "results of b/x.eng: choose another folder for those of a/x.eng by --out";
    assert!(refused.replace('\\', "/").ends_with(told), "{refused}");
    // the text has moved
    std::fs::remove_file(here.join(second)).unwrap();
    assert_eq!(claim(first), Ok(()));
    std::fs::remove_dir_all(&here).unwrap();
}

#[test]
fn progress_names_the_angle_or_the_time() {
    let mut progress = Progress {
        fraction: 0.5,
        time: 0.03,
        steps: 0,
        cycle_angle: Some(4.0 * std::f64::consts::PI),
        cycles: None,
    };
    assert_eq!(place(progress), "720 °CA");
    progress.cycle_angle = None;
    assert_eq!(place(progress), "0.030000 s");
    progress.cycles = Some((3, Some(0.0125)));
    assert_eq!(place(progress), "3 cycles, 1.250 % change");
    progress.cycles = None;
    let bar = progress_bar("unfired");
    show_progress(&bar, progress);
    assert_eq!((bar.position(), bar.length()), (500, Some(1000)));
}

#[test]
fn the_words_below_stay_as_long_as_a_bar() {
    let progress = Progress {
        fraction: 0.5,
        time: 0.03,
        steps: 0,
        cycle_angle: None,
        cycles: None,
    };
    let mut bars = Bars::new(2, true, Some("Ctrl-C keeps the samples"));
    bars.show(0, "first", progress);
    bars.show(1, "second", progress);
    bars.end(0);
    let words = bars.below.as_ref().map(ProgressBar::message);
    assert_eq!(words.as_deref(), Some("Ctrl-C keeps the samples"));
    bars.end(1);
    assert!(bars.below.is_none());
}

#[test]
fn parameters_are_shown_as_written() {
    for (kept, shown) in [
        ("86.00000000000001 mm", "86 mm"),
        ("0.1234567890123456 N*m/rad", "0.123456789012 N*m/rad"),
        ("1", "1"),
        ("0.0000004 m", "4e-7 m"),
        ("a text 1", "a text 1"),
    ] {
        assert_eq!(rounded(kept), shown);
    }
}
