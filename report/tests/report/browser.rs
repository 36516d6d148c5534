//! The page in a headless Chromium: drawn, zoomed, read out, moved.

use super::demo;
use super::tools::{beside, find, find_or, folder, run, skip};
use serde_json::Value;
use std::process::Command;

#[test]
fn the_page_lives_in_a_browser() {
    let browser = find_or(
        "ENG_TEST_CHROMIUM",
        &["chromium", "chromium-browser", "google-chrome"],
    );
    let (Some(browser), Some(node)) = (browser, find(&["node"])) else {
        return skip("Chromium with Node.js");
    };
    let folder = folder("browser");
    let page = folder.join("report.html");
    std::fs::write(&page, demo::page().to_html().unwrap()).unwrap();
    let output = run(Command::new(node)
        .arg(beside("browser.mjs"))
        .arg(browser)
        .arg(&page)
        .arg(&folder));
    assert!(output.status.success(), "{}", output.status);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    eprintln!("{found:#}");
    let number = |name: &str| found[name].as_f64().unwrap();
    assert_eq!(found["errors"], Value::Array(Vec::new()), "console");
    assert_eq!(found["requests"], Value::Array(Vec::new()), "network");
    assert_eq!(number("figures"), 7.0);
    assert_eq!(number("animations"), 1.0);
    assert!(number("links") > 5.0);
    assert_eq!(found["missed_links"], Value::Array(Vec::new()), "links");
    // 2 panels of 5 curves, hidden one by one
    assert_eq!(number("curves"), 10.0);
    assert_eq!(number("curves_after_hiding"), 8.0);
    // the wheel zooms, a double click shows all again
    assert!(number("ticks_step_zoomed") < number("ticks_step"), "zoom");
    assert_eq!(found["zoomed_by_drag"], Value::Bool(true));
    assert_eq!(found["reset"], Value::Bool(true));
    for name in [
        "readout_history",
        "readout_orbit",
        "readout_map",
        "readout_waterfall",
    ] {
        let text = found[name].as_str().unwrap();
        assert!(!text.is_empty() && !text.contains("NaN"), "{name}: {text}");
    }
    assert!(found["readout_history"].as_str().unwrap().contains("°CA"));
    assert!(found["readout_map"].as_str().unwrap().contains("dB re"));
    // by body, and in the colours of the stress
    let still = &found["without_scripts"];
    assert_eq!(
        (&still["drawings"], &still["posters"], &still["controls"]),
        (&7.into(), &2.into(), &0.into())
    );
    match found.get("accessibility") {
        Some(violations) => {
            for scheme in ["light", "dark"] {
                assert_eq!(violations[scheme], Value::Array(Vec::new()), "{scheme}");
            }
        }
        None => skip("axe-core (npm)"),
    }
    // no part is wider than the window, in a wide and in a narrow one
    assert!(number("overflow_wide") <= 0.0 && number("overflow_narrow") <= 0.0);
    if found["webgl"] == Value::Bool(false) {
        return skip("WebGL 2 in Chromium");
    }
    assert_ne!(
        found["clock_before"], found["clock_after"],
        "the animation plays"
    );
    assert!(number("drawn") > 3.0);
    assert_eq!(found["colors"], "film");
    assert_eq!(found["film"], "60 MPa, pressure of films");
    assert_ne!(
        found["picture_start"], found["picture_later"],
        "pixels move"
    );
    assert_ne!(
        found["picture_start"], found["picture_undeformed"],
        "the scale acts"
    );
    assert_ne!(
        found["picture_start"], found["picture_turned"],
        "the camera turns"
    );
    assert_eq!(
        found["glb_bytes"].as_f64(),
        Some(demo::animation().to_glb().unwrap().len() as f64)
    );
}
