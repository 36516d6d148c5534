//! Sections of the shapes of beams, by hand.

use eng_flexible::internals::read::section;
use std::f64::consts::PI;

fn close(found: f64, expected: f64, scale: f64) {
    assert!(
        (found - expected).abs() <= 1e-13 * scale,
        "{found} is not {expected}"
    );
}

#[test]
fn round_sections() {
    let rod = section("ROD", &[2.0]).unwrap();
    close(rod.area, 4.0 * PI, 10.0);
    close(rod.moment_y, 4.0 * PI, 10.0);
    close(rod.torsion, 8.0 * PI, 10.0);
    let tube = section("TUBE", &[2.0, 1.0]).unwrap();
    close(tube.area, 3.0 * PI, 10.0);
    close(tube.moment_z, 15.0 / 4.0 * PI, 10.0);
    assert_eq!(section("TUBE2", &[2.0, 1.0]), Some(tube));
    assert_eq!(section("TUBE", &[1.0, 2.0]), None);
}

#[test]
fn a_square_bar_has_the_torsion_of_the_series() {
    // de Saint-Venant: 0.140577 a⁴
    let bar = section("BAR", &[1.0, 1.0]).unwrap();
    assert!((bar.torsion / 0.140577 - 1.0).abs() < 0.005);
    let flat = section("BAR", &[2.0, 6.0]).unwrap();
    close(flat.moment_z, 36.0, 36.0);
    close(flat.moment_y, 4.0, 36.0);
}

#[test]
fn an_angle_by_hand() {
    // foot 10×1, leg 1×9 above it: centroids (0.5, 5) and (5.5, 0.5)
    let angle = section("L", &[10.0, 10.0, 1.0, 1.0]).unwrap();
    close(angle.area, 19.0, 19.0);
    let y = (10.0 * 0.5 + 9.0 * 5.5) / 19.0;
    let z = (10.0 * 5.0 + 9.0 * 0.5) / 19.0;
    let moment = 10.0 / 12.0
        + 10.0 * (y - 0.5) * (y - 0.5)
        + 9.0 * 81.0 / 12.0
        + 9.0 * (5.5 - y) * (5.5 - y);
    close(angle.moment_z, moment, 200.0);
    close(angle.moment_y, moment, 200.0);
    let product = 10.0 * (0.5 - y) * (5.0 - z) + 9.0 * (5.5 - y) * (0.5 - z);
    close(angle.product, product, 200.0);
    assert!(product < 0.0);
    close(angle.torsion, 2.0 * 9.5 / 3.0, 10.0);
}

#[test]
fn a_box_by_hand() {
    let hollow = section("BOX", &[10.0, 20.0, 1.0, 2.0]).unwrap();
    close(hollow.area, 200.0 - 6.0 * 18.0, 200.0);
    close(hollow.moment_z, (10.0 * 8000.0 - 6.0 * 5832.0) / 12.0, 1e4);
    close(hollow.moment_y, (20.0 * 1000.0 - 18.0 * 216.0) / 12.0, 1e4);
    // 2 t₁ t₂ (b − t₂)² (h − t₁)² / (b t₂ + h t₁ − t₂² − t₁²)
    let bredt = 2.0 * 2.0 * 64.0 * 361.0 / (20.0 + 20.0 - 4.0 - 1.0);
    close(hollow.torsion, bredt, 1e4);
    assert_eq!(
        section("BOX1", &[10.0, 20.0, 1.0, 1.0, 2.0, 2.0]),
        Some(hollow)
    );
}

#[test]
fn open_shapes_by_hand() {
    let beam = section("I", &[20.0, 10.0, 10.0, 1.0, 2.0, 2.0]).unwrap();
    close(beam.area, 56.0, 56.0);
    close(beam.moment_z, (10.0 * 8000.0 - 9.0 * 4096.0) / 12.0, 1e4);
    close(beam.moment_y, (4.0 * 1000.0 + 16.0) / 12.0, 1e3);
    close(beam.torsion, (2.0 * 10.0 * 8.0 + 18.0) / 3.0, 100.0);
    close(beam.shear[0], 16.0 / 56.0, 1.0);
    close(beam.shear[1], 40.0 / 56.0, 1.0);
    assert_eq!(section("I1", &[9.0, 1.0, 16.0, 20.0]), Some(beam));
    // the same area for every way to say the same walls
    let channel = section("CHAN", &[10.0, 20.0, 1.0, 2.0]).unwrap();
    assert_eq!(section("CHAN1", &[9.0, 1.0, 16.0, 20.0]), Some(channel));
    close(channel.area, 56.0, 56.0);
    let up = section("T", &[10.0, 20.0, 2.0, 1.0]).unwrap();
    let down = section("T2", &[10.0, 20.0, 2.0, 1.0]).unwrap();
    close(up.moment_z, down.moment_z, 1e4);
    let side = section("T1", &[10.0, 18.0, 2.0, 1.0]).unwrap();
    close(side.moment_y, up.moment_z, 1e4);
    close(side.moment_z, up.moment_y, 1e4);
}

#[test]
fn shapes_of_several_arms() {
    let cross = section("CROSS", &[8.0, 2.0, 10.0, 2.0]).unwrap();
    close(cross.area, 36.0, 36.0);
    close(cross.moment_y, cross.moment_z, 1e3);
    let h = section("H", &[6.0, 4.0, 10.0, 2.0]).unwrap();
    close(h.area, 52.0, 52.0);
    close(h.moment_y, 10.0 * 1000.0 / 12.0 - 8.0 * 216.0 / 12.0, 1e3);
    let z = section("Z", &[5.0, 1.0, 8.0, 10.0]).unwrap();
    close(z.area, 20.0, 20.0);
    // flanges of area 5 at (4.5, −3) and (−4.5, 3)
    close(z.product, -2.0 * 5.0 * 4.5 * 3.0, 1e3);
    let hat = section("HAT", &[10.0, 1.0, 8.0, 4.0]).unwrap();
    close(hat.area, 8.0 + 2.0 * 8.0 + 2.0 * 5.0, 40.0);
    close(hat.product, 0.0, 1.0);
    let stool = section("CHAN2", &[1.0, 2.0, 10.0, 8.0]).unwrap();
    close(stool.area, 20.0 + 12.0, 40.0);
}

#[test]
fn a_hexagon_of_rectangles_and_triangles() {
    // without tips it is a bar
    let hexagon = section("HEXA", &[0.0, 4.0, 6.0]).unwrap();
    close(hexagon.moment_z, 72.0, 72.0);
    close(hexagon.moment_y, 32.0, 72.0);
    // a regular one of side 1: area 3√3/2, both moments 5√3/16
    let root = 3.0_f64.sqrt();
    let regular = section("HEXA", &[0.5, 2.0, root]).unwrap();
    close(regular.area, 1.5 * root, 3.0);
    close(regular.moment_z, 5.0 * root / 16.0, 1.0);
    close(regular.moment_y, 5.0 * root / 16.0, 1.0);
}

#[test]
fn wrong_dimensions_make_no_section() {
    for (shape, dimensions) in [
        ("BOX", vec![1.0, 1.0, 0.6, 0.1]),
        ("I", vec![1.0, 1.0, 1.0, 0.1, 0.6, 0.6]),
        ("BAR", vec![-1.0, 1.0]),
        ("ROD", vec![f64::NAN]),
        ("ROD", vec![1e300]),
        ("L", vec![1.0, 1.0, 1.0]),
    ] {
        assert_eq!(section(shape, &dimensions), None, "{shape}");
    }
}
