//! Rules of the checker's types: points and differences, angles, powers of dimensions.

use eng_compiler::internals::{Dim, Kind, Misfit, Quantity};
use eng_system::Dimension;

fn point(name: &str) -> Quantity {
    Quantity {
        kind: Kind::Point(name.into()),
        ..Quantity::hard(Dimension::base(4))
    }
}

#[test]
fn points_differ_and_differences_move_them() {
    let t = point("Temperature");
    let difference = t.plus(&t, true).expect("a difference");
    assert_eq!(difference.kind, Kind::Difference);
    assert_eq!(
        t.plus(&difference, false).map(|q| q.kind),
        Ok(t.kind.clone())
    );
    assert_eq!(t.plus(&t, false), Err(Misfit::Point));
    assert_eq!(difference.plus(&t, true), Err(Misfit::Point));
    assert_eq!(difference.fits(&t), Err(Misfit::Point));
}

#[test]
fn declared_angles_stay_and_computed_ones_go() {
    let per_second = Quantity::hard(Dimension::TIME.power(-1, 1).expect("1/s"));
    let speed = Quantity::hard(Dimension::ANGLE.over(Dimension::TIME));
    assert_eq!(per_second.fits(&speed), Err(Misfit::Angle));
    let computed = Quantity::hard(Dimension::LENGTH)
        .over(&Quantity::hard(Dimension::TIME))
        .over(&Quantity::hard(Dimension::LENGTH));
    assert_eq!(computed.fits(&speed), Ok(()));
    let doubled = Quantity::one().times(&per_second);
    assert_eq!(doubled.fits(&speed), Err(Misfit::Angle));
}

#[test]
fn variables_have_powers() {
    let d = Dim::variable(3);
    let square = d.times(&d);
    assert_eq!(square.power(1, 2), Some(d.clone()));
    assert!(square.over(&d).over(&d).is_one());
}
