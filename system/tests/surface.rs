//! Shapes of surfaces.

use eng_system::surface::{SurfaceShape, SurfaceShapes};

#[test]
fn shapes_have_their_order_and_values() {
    let shapes = SurfaceShapes {
        around: 2,
        across: 2,
    };
    let each: Vec<SurfaceShape> = shapes.each().collect();
    assert_eq!(each.len(), shapes.count());
    let last = each[each.len() - 1];
    assert_eq!((last.around, last.sine, last.across), (2, true, 2));
    // P₂(ζ) = (3 ζ² − 1)/2
    let value = last.value(0.3, 0.8);
    assert!((value - libm::sin(0.6) * (3.0 * 0.64 - 1.0) / 2.0).abs() < 1e-15);
    assert_eq!(each[0].value(1.0, 0.5), 1.0);
}
