//! Hills of the pressure of films.

use eng_report::animation::{FilmSurface, Films, Pose, Surface};
use eng_report::internals::{check_film, film_field, film_hill, film_range};

fn film() -> FilmSurface {
    FilmSurface {
        name: "main".to_owned(),
        surface: Surface {
            nodes: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: Vec::new(),
        },
        outward: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        poses: vec![Pose::HOME],
        moments: vec![2, 4, 8],
        pressures: vec![vec![0.0, 4.0], vec![2.0, 8.0], vec![10.0, 0.0]],
    }
}

#[test]
fn pressures_between_moments_lie_on_straight_lines() {
    let film = film();
    let at = |time| film_field(&film, time, "MPa").values;
    // the first moment holds before it, the last one after it
    assert_eq!(at(0), [0.0, 4.0]);
    assert_eq!(at(3), [1.0, 6.0]);
    assert_eq!(at(4), [2.0, 8.0]);
    assert_eq!(at(6), [6.0, 4.0]);
    assert_eq!(at(9), [10.0, 0.0]);
}

#[test]
fn hills_have_one_scale() {
    let films = Films {
        surfaces: vec![film()],
        unit: "MPa".to_owned(),
        height: 5e-3,
    };
    assert_eq!(film_range(&films), [0.0, 10.0]);
    let hill = film_hill(&films, &films.surfaces[0], &[10.0, 4.0]);
    assert_eq!(hill, [[5e-3, 0.0, 0.0], [0.0, 2e-3, 0.0]]);
    assert_eq!(film_range(&Films::default()), [0.0; 2]);
}

#[test]
fn moments_and_pressures_must_fit() {
    let of = |change: fn(&mut FilmSurface)| {
        let mut film = film();
        change(&mut film);
        check_film(&film, 9)
    };
    assert_eq!(of(|_| ()), Ok(()));
    assert!(of(|film| film.moments[2] = 9).is_err());
    assert!(of(|film| film.moments.swap(0, 1)).is_err());
    assert!(of(|film| film.moments.truncate(2)).is_err());
    assert!(of(|film| film.pressures[1].truncate(1)).is_err());
    assert!(of(|film| film.pressures[0][0] = f64::NAN).is_err());
    assert!(of(|film| film.outward.truncate(1)).is_err());
}
