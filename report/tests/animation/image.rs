//! Triangles and lines of a still picture.

use eng_report::internals::image::{Canvas, Vertex};

fn vertex(x: f64, y: f64, near: f64) -> Vertex {
    Vertex { x, y, near }
}

#[test]
fn what_is_nearer_hides_the_rest_whatever_comes_first() {
    let mut canvas = Canvas::new(10, 10);
    let all = |near| {
        [
            vertex(-20.0, -20.0, near),
            vertex(40.0, 0.0, near),
            vertex(0.0, 40.0, near),
        ]
    };
    canvas.triangle(all(1.0), [255, 0, 0]);
    canvas.triangle(all(0.0), [0, 255, 0]);
    assert_eq!(canvas.pixel(5, 5), [255, 0, 0, 255]);
    let small = [
        vertex(0.0, 0.0, 2.0),
        vertex(4.0, 0.0, 2.0),
        vertex(0.0, 4.0, 2.0),
    ];
    canvas.triangle(small, [0, 0, 255]);
    assert_eq!(canvas.pixel(0, 0), [0, 0, 255, 255]);
    assert_eq!(canvas.pixel(5, 5), [255, 0, 0, 255]);
}

#[test]
fn the_ground_is_transparent_and_numbers_that_are_none_draw_nothing() {
    let mut canvas = Canvas::new(4, 4);
    canvas.triangle([vertex(f64::NAN, 0.0, 0.0); 3], [1; 3]);
    canvas.line(
        vertex(f64::INFINITY, 0.0, 0.0),
        vertex(0.0, 0.0, 0.0),
        0.0,
        [1; 3],
    );
    assert!((0..16).all(|i| canvas.pixel(i % 4, i / 4) == [0; 4]));
    canvas.line(vertex(0.0, 2.0, 0.0), vertex(4.0, 2.0, 0.0), 0.0, [9, 9, 9]);
    assert_eq!(canvas.pixel(1, 1)[..3], [9, 9, 9]);
    assert_eq!(canvas.pixel(1, 3)[3], 0);
    assert_eq!(&canvas.to_png()[..8], b"\x89PNG\r\n\x1a\n");
}
