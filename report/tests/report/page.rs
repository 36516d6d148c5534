//! The page's text, without a browser.

use super::demo;
use super::tools::folder;

#[test]
fn a_whole_page_stands_alone() {
    let text = demo::page().to_html().unwrap();
    std::fs::write(folder("page").join("report.html"), &text).unwrap();
    assert_eq!(text.matches("<figure class=\"plot\"").count(), 7);
    assert_eq!(text.matches("<figure class=\"animation\"").count(), 1);
    assert_eq!(text.matches("<h1>").count(), 1);
    assert_eq!(text.matches("<h2 ").count(), 7);
    // the only addresses are names of namespaces
    let addresses = text.matches("http").count();
    let namespaces = text.matches("xmlns=\"http://www.w3.org/2000/svg\"").count();
    assert_eq!(addresses, namespaces + text.matches("http-equiv").count());
    // without scripts, and without the letters of packed bytes
    let markup: String = text
        .split("<script>")
        .next()
        .unwrap()
        .split("base64,")
        .flat_map(|part| part.split("class=\"model\">"))
        .map(|part| {
            part.trim_start_matches(|c: char| c.is_ascii_alphanumeric() || "+/=".contains(c))
        })
        .collect();
    for wrong in ["NaN", ">inf", "@import", "url(h"] {
        assert!(!markup.contains(wrong), "{wrong}");
    }
    assert_eq!(
        text.matches("src=").count(),
        text.matches("src=\"data:image/").count()
    );
    assert!(text.contains("Made-up engine &lt;4 cylinders&gt;"));
    // all ids are different
    let mut ids: Vec<&str> = text
        .split(" id=\"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
        .collect();
    let count = ids.len();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), count);
    assert!(text.len() < 2_000_000, "{} bytes", text.len());
}

#[test]
fn the_same_page_has_the_same_bytes() {
    assert_eq!(
        demo::page().to_html().unwrap(),
        demo::page().to_html().unwrap()
    );
}
