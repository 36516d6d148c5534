//! Pages, their tables and audits.

use eng_report::internals::page::{FIGURES, VIEWER, shortened, significant};
use eng_report::page::{Cell, Column, EnergyAudit, Page, Section, Table};

#[test]
fn everything_is_escaped_and_nothing_comes_from_elsewhere() {
    let hostile = "</script><script>alert(1)</script>\"'&";
    let page = Page::new(hostile).subtitle(hostile).section(
        Section::new(hostile)
            .paragraph(hostile)
            .warning(hostile)
            .facts([(hostile, hostile)])
            .list([hostile])
            .code(hostile)
            .section(Section::new(hostile)),
    );
    let text = page.to_html().unwrap();
    assert!(!text.contains("alert(1)</script>") && !text.contains("<script>"));
    assert!(!text.contains("http://") && !text.contains("https://"));
    assert_eq!(text.matches("<h1>").count(), 1);
    assert!(text.contains("<h2 id=\"section-1\">") && text.contains("<h3 id=\"section-2\">"));
}

#[test]
fn figures_have_the_pages_numbers_as_files() {
    let svg = "<svg xmlns=\"http://www.w3.org/2000/svg\"/>";
    let page = Page::new("A")
        .section(Section::new("B").section(Section::new("C").drawing(svg, "first", "")))
        .section(Section::new("D").drawing(svg, "second", "What it shows."));
    let found = page.figures();
    let numbers: Vec<(usize, &str)> = found
        .iter()
        .map(|f| (f.number, f.caption.as_str()))
        .collect();
    assert_eq!(numbers, [(1, "first"), (2, "What it shows.")]);
    assert_eq!(found[1].svg, svg);
    let text = page.to_html().unwrap();
    assert!(text.contains("<b>Figure 2.</b> What it shows."));
    assert!(text.contains("<img alt=\"first\" src=\"data:image/svg+xml;base64,"));
    // lists within lists end at the right place
    assert_eq!(text.matches("<li>").count(), text.matches("</li>").count());
    assert_eq!(text.matches("<ul>").count(), text.matches("</ul>").count());
}

#[test]
fn scripts_cannot_end_themselves() {
    for script in [FIGURES, VIEWER] {
        assert!(!script.contains("</script") && !script.contains("<!--"));
        assert!(!script.contains("http") && !script.contains("import("));
    }
}

#[test]
fn numbers_read_well() {
    for (value, digits, text) in [
        (0.0, 4, "0"),
        (1234.5678, 4, "1235"),
        (9.9996, 4, "10.00"),
        (-0.0012345, 3, "−0.00123"),
        (2.1e11, 3, "2.10·10<sup>11</sup>"),
        (-3.2e-7, 2, "−3.2·10<sup>−7</sup>"),
        (f64::NAN, 4, "–"),
    ] {
        assert_eq!(significant(value, digits), text);
    }
    for (text, short) in [
        ("4000.00", "4000"),
        ("0.112000", "0.112"),
        ("100000", "100000"),
        ("−1.50000·10<sup>20</sup>", "−1.5·10<sup>20</sup>"),
        ("–", "–"),
    ] {
        assert_eq!(shortened(text), short);
    }
}

#[test]
fn cells_are_escaped_and_rows_are_filled() {
    let table = Table {
        caption: "a<b".to_owned(),
        columns: vec![Column::new("x"), Column::with_unit("y", "N")],
        rows: vec![vec![Cell::Code("<i>".to_owned())]],
    };
    let page = Page::new("A").section(Section::new("B").table(table));
    let text = page.to_html().unwrap();
    assert!(text.contains("<caption>a&lt;b</caption>"));
    assert!(
        text.contains("<code>&lt;i&gt;</code>") && text.contains("<td class=\"number\">–</td>")
    );
    assert!(text.contains("y <span class=\"unit\">(N)</span>"));
}

#[test]
fn an_audit_that_balances() {
    let audit = EnergyAudit {
        work: vec![("gas".to_owned(), 100.0), ("drive".to_owned(), 5.0)],
        losses: vec![("films".to_owned(), 60.0)],
        stored: 44.0,
    };
    assert_eq!(audit.residual(), 1.0);
    assert_eq!(audit.relative_residual(), 0.01);
    let table = audit.table("Energy");
    assert_eq!(table.rows.len(), 6);
    assert_eq!(
        table.rows[2][2],
        Cell::Fixed {
            value: -60.0,
            decimals: 3
        }
    );
}
