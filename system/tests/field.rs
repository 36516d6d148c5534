//! Results of field kernels.

use eng_system::field::{Kernel, drives};

#[test]
fn results_have_places_of_their_own() {
    let film = Kernel::named("reynolds").unwrap();
    assert_eq!(film.answer_count(), 7);
    let (row, first, answer) = film.result("torque").unwrap();
    assert_eq!((row.count, first, answer), (1, 4, true));
    let (row, first, answer) = film.result("damping").unwrap();
    assert_eq!((row.count, first + row.count), (4, film.reading_count()));
    assert!(!answer && film.result("friction").is_none());
    let count: u32 = drives(film, 3).map(|(_, count)| count).sum();
    assert_eq!(count, 15);
}
