//! Sections given by shape and dimensions (`PBARL`, `PBEAML`).
//!
//! y is up and z to the right in the drawings of the Nastran manuals. A shape is a sum of rectangles (walls);
//! area, centroid and second moments follow from them exactly. Torsion of an open section is Σ length ·
//! thickness³ / 3 over the mid-lines of its walls, of a closed one Bredt's 4 A²/∮ds/t with constant walls (S.
//! Timoshenko, Strength of Materials II). A wall carries shear along its length only: the factor is the
//! walls' share of the area; 9/10 for a round bar, 1/2 for a thin tube, 5/6 for a rectangle.

use std::f64::consts::PI;

use crate::mesh::BeamSection;

/// Number of dimensions of a shape; `None` for a shape that isn't known.
pub(super) fn dimension_count(shape: &str) -> Option<usize> {
    Some(match shape {
        "ROD" => 1,
        "TUBE" | "TUBE2" | "BAR" => 2,
        "HEXA" => 3,
        "BOX" | "T" | "T1" | "T2" | "I1" | "L" | "CHAN" | "CHAN1" | "CHAN2" | "H" | "CROSS"
        | "Z" | "HAT" => 4,
        "I" | "BOX1" => 6,
        _ => return None,
    })
}

/// Whether the shear centre of a shape is its centroid by symmetry about a point.
pub(super) fn is_centred(shape: &str, dimensions: &[f64]) -> bool {
    match (shape, dimensions) {
        ("T" | "T1" | "T2" | "L" | "CHAN" | "CHAN1" | "CHAN2" | "HAT", _) => false,
        ("I", &[_, a, b, _, ta, tb]) => a == b && ta == tb,
        ("BOX1", &[_, _, top, bottom, left, right]) => top == bottom && left == right,
        _ => true,
    }
}

/// A wall: centre, extent along y and z, thickness and length of its mid-line in torsion.
struct Wall {
    y: f64,
    z: f64,
    height: f64,
    width: f64,
    thickness: f64,
    line: f64,
    upright: bool,
}

/// A wall upright, whose shear is along y.
fn upright(y: f64, z: f64, height: f64, thickness: f64, line: f64) -> Wall {
    Wall {
        y,
        z,
        height,
        width: thickness,
        thickness,
        line,
        upright: true,
    }
}

/// A wall lying, whose shear is along z.
fn lying(y: f64, z: f64, width: f64, thickness: f64, line: f64) -> Wall {
    Wall {
        y,
        z,
        height: thickness,
        width,
        thickness,
        line,
        upright: false,
    }
}

/// The section of a shape: y up, shear factors along y and z; `None` if the dimensions do not give a section.
pub fn section(shape: &str, dimensions: &[f64]) -> Option<BeamSection> {
    if dimensions.iter().any(|d| *d < 0.0 || !d.is_finite()) {
        return None;
    }
    let section = match (shape, dimensions) {
        ("ROD", &[r]) => tube(r, 0.0),
        ("TUBE", &[outer, inner]) => tube(outer, inner),
        ("TUBE2", &[outer, thickness]) => tube(outer, outer - thickness),
        ("BAR", &[width, height]) => bar(width, height),
        ("HEXA", &[tip, width, height]) => hexagon(tip, width, height),
        ("BOX", &[width, height, lid, side]) => closed_box(width, height, [lid, lid], [side, side]),
        ("BOX1", &[width, height, top, bottom, left, right]) => {
            closed_box(width, height, [top, bottom], [left, right])
        }
        ("I", &[h, a, b, web, ta, tb]) => {
            let clear = h - ta - tb;
            open(&[
                lying(0.5 * ta, 0.0, a, ta, a),
                upright(ta + 0.5 * clear, 0.0, clear, web, h - 0.5 * (ta + tb)),
                lying(h - 0.5 * tb, 0.0, b, tb, b),
            ])
        }
        ("I1", &[overhang, web, clear, h]) => {
            let t = 0.5 * (h - clear);
            let width = overhang + web;
            open(&[
                lying(0.5 * t, 0.0, width, t, width),
                upright(0.5 * h, 0.0, clear, web, h - t),
                lying(h - 0.5 * t, 0.0, width, t, width),
            ])
        }
        ("T", &[width, h, flange, web]) => open(&[
            lying(h - 0.5 * flange, 0.0, width, flange, width),
            upright(0.5 * (h - flange), 0.0, h - flange, web, h - 0.5 * flange),
        ]),
        ("T2", &[width, h, flange, web]) => open(&[
            lying(0.5 * flange, 0.0, width, flange, width),
            upright(0.5 * (h + flange), 0.0, h - flange, web, h - 0.5 * flange),
        ]),
        ("T1", &[height, length, flange, web]) => open(&[
            upright(0.0, 0.5 * flange, height, flange, height),
            lying(0.0, -0.5 * length, length, web, length + 0.5 * flange),
        ]),
        ("L", &[width, h, foot, leg]) => open(&[
            lying(0.5 * foot, 0.5 * width, width, foot, width - 0.5 * leg),
            upright(0.5 * (h + foot), 0.5 * leg, h - foot, leg, h - 0.5 * foot),
        ]),
        ("CHAN", &[width, h, web, flange]) => channel(width, h, web, flange),
        ("CHAN1", &[overhang, web, clear, h]) => channel(overhang + web, h, web, 0.5 * (h - clear)),
        ("CHAN2", &[leg, base, h, width]) => open(&[
            lying(0.5 * base, 0.0, width - 2.0 * leg, base, width - leg),
            upright(0.5 * h, 0.5 * (leg - width), h, leg, h - 0.5 * base),
            upright(0.5 * h, 0.5 * (width - leg), h, leg, h - 0.5 * base),
        ]),
        ("H", &[bar, legs, h, t]) => {
            let leg = 0.5 * legs;
            let z = 0.5 * (bar + leg);
            open(&[
                lying(0.0, 0.0, bar, t, bar + leg),
                upright(0.0, z, h, leg, h),
                upright(0.0, -z, h, leg, h),
            ])
        }
        ("CROSS", &[arms, web, h, t]) => {
            let arm = 0.5 * arms;
            let z = 0.5 * (arm + web);
            open(&[
                upright(0.0, 0.0, h, web, h),
                lying(0.0, z, arm, t, arm),
                lying(0.0, -z, arm, t, arm),
            ])
        }
        ("Z", &[overhang, web, clear, h]) => {
            let t = 0.5 * (h - clear);
            let z = 0.5 * (overhang + web);
            let line = overhang + 0.5 * web;
            open(&[
                upright(0.0, 0.0, h, web, h - t),
                lying(0.5 * (h - t), -z, overhang, t, line),
                lying(0.5 * (t - h), z, overhang, t, line),
            ])
        }
        ("HAT", &[h, t, top, foot]) => {
            let z = 0.5 * (top - t);
            let side = 0.5 * (top + foot);
            open(&[
                lying(h - 0.5 * t, 0.0, top, t, top - t),
                upright(0.5 * h, z, h - 2.0 * t, t, h - t),
                upright(0.5 * h, -z, h - 2.0 * t, t, h - t),
                lying(0.5 * t, side - 0.5 * t, foot + t, t, foot + 0.5 * t),
                lying(0.5 * t, 0.5 * t - side, foot + t, t, foot + 0.5 * t),
            ])
        }
        _ => None,
    }?;
    let sound = section.area > 0.0
        && section.area.is_finite()
        && section.moment_y > 0.0
        && section.moment_z > 0.0
        && section.torsion > 0.0;
    sound.then_some(section)
}

/// A round bar or tube: A = π (R² − r²), I = π (R⁴ − r⁴)/4, J = 2 I. The shear factor is that of a solid bar
/// or of a thin tube.
fn tube(outer: f64, inner: f64) -> Option<BeamSection> {
    if !(0.0..outer).contains(&inner) {
        return None;
    }
    let square = |x: f64| x * x;
    let moment = 0.25 * PI * (square(square(outer)) - square(square(inner)));
    let shear = if inner > 0.0 { 0.5 } else { 0.9 };
    Some(BeamSection {
        area: PI * (square(outer) - square(inner)),
        moment_z: moment,
        moment_y: moment,
        torsion: 2.0 * moment,
        shear: [shear, shear],
        ..BeamSection::default()
    })
}

/// A rectangle. J = a b³ (1/3 − 0.21 b/a (1 − b⁴/12 a⁴)) with a ≥ b, 0.5 % or better (W. Young, Roark's
/// Formulas, table 10.1).
fn bar(width: f64, height: f64) -> Option<BeamSection> {
    let (a, b) = (width.max(height), width.min(height));
    if b <= 0.0 {
        return None;
    }
    let ratio = b / a;
    let fourth = ratio * ratio * ratio * ratio;
    Some(BeamSection {
        area: width * height,
        moment_z: width * height * height * height / 12.0,
        moment_y: height * width * width * width / 12.0,
        torsion: a * b * b * b * (1.0 / 3.0 - 0.21 * ratio * (1.0 - fourth / 12.0)),
        shear: [5.0 / 6.0, 5.0 / 6.0],
        ..BeamSection::default()
    })
}

/// A hexagon with tips left and right of the given width each. The torsion constant is de Saint-Venant's
/// A⁴/(40 Iₚ), good to a few per cent for compact solids.
fn hexagon(tip: f64, width: f64, height: f64) -> Option<BeamSection> {
    let core = width - 2.0 * tip;
    if core < 0.0 {
        return None;
    }
    let area = height * (core + tip);
    // triangles of base `height` and altitude `tip`: their own moments, and Steiner's for z
    let cube = height * height * height;
    let moment_z = core * cube / 12.0 + tip * cube / 24.0;
    let arm = 0.5 * core + tip / 3.0;
    let moment_y = height * core * core * core / 12.0
        + 2.0 * (height * tip * tip * tip / 36.0 + 0.5 * height * tip * arm * arm);
    let fourth = area * area * area * area;
    Some(BeamSection {
        area,
        moment_z,
        moment_y,
        torsion: fourth / (40.0 * (moment_y + moment_z)),
        shear: [5.0 / 6.0, 5.0 / 6.0],
        ..BeamSection::default()
    })
}

/// A closed box with walls of thickness `[top, bottom]` and `[left, right]`.
fn closed_box(
    width: f64,
    height: f64,
    [top, bottom]: [f64; 2],
    [left, right]: [f64; 2],
) -> Option<BeamSection> {
    let clear = height - top - bottom;
    let inner = width - left - right;
    if clear <= 0.0 || inner <= 0.0 || [top, bottom, left, right].iter().any(|t| *t <= 0.0) {
        return None;
    }
    let y = bottom + 0.5 * clear;
    let mut section = open(&[
        lying(height - 0.5 * top, 0.5 * width, width, top, width),
        lying(0.5 * bottom, 0.5 * width, width, bottom, width),
        upright(y, 0.5 * left, clear, left, clear),
        upright(y, width - 0.5 * right, clear, right, clear),
    ])?;
    let (w, h) = (width - 0.5 * (left + right), height - 0.5 * (top + bottom));
    let around = w / top + w / bottom + h / left + h / right;
    section.torsion = 4.0 * (w * h) * (w * h) / around;
    Some(section)
}

/// A channel open to the right.
fn channel(width: f64, height: f64, web: f64, flange: f64) -> Option<BeamSection> {
    let overhang = width - web;
    let line = width - 0.5 * web;
    let z = web + 0.5 * overhang;
    open(&[
        upright(0.5 * height, 0.5 * web, height, web, height - flange),
        lying(height - 0.5 * flange, z, overhang, flange, line),
        lying(0.5 * flange, z, overhang, flange, line),
    ])
}

/// A section of walls.
fn open(walls: &[Wall]) -> Option<BeamSection> {
    let (mut area, mut y, mut z) = (0.0, 0.0, 0.0);
    for wall in walls {
        if wall.height < 0.0 || wall.width < 0.0 || wall.line < 0.0 {
            return None;
        }
        let a = wall.height * wall.width;
        area += a;
        y += a * wall.y;
        z += a * wall.z;
    }
    if area <= 0.0 {
        return None;
    }
    let (y, z) = (y / area, z / area);
    let mut section = BeamSection {
        area,
        ..BeamSection::default()
    };
    for wall in walls {
        let a = wall.height * wall.width;
        let (dy, dz) = (wall.y - y, wall.z - z);
        section.moment_z += a * (wall.height * wall.height / 12.0 + dy * dy);
        section.moment_y += a * (wall.width * wall.width / 12.0 + dz * dz);
        section.product += a * dy * dz;
        let t = wall.thickness;
        section.torsion += wall.line * t * t * t / 3.0;
        let [along_y, along_z] = &mut section.shear;
        *if wall.upright { along_y } else { along_z } += a / area;
    }
    Some(section)
}
