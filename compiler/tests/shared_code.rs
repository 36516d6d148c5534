//! Models with other constants share the machine code of the classes that the constants do not change.

use crate::check_support::{Folder, run_in};
use eng_compiler::elaborate::analyses;
use eng_compiler::models::SharedModels;
use eng_grammar::Diagnostics;
use eng_system::code::ElementCode;
use std::sync::Arc;

const TEXT: &str = "
/// A torque whose law the argument `cubic` chooses.
force Stiffener(turning: Marker, base: Marker, stiffness: Torque, cubic: Bool) {
    let angle = rotation(turning, base)
    apply torque -stiffness*(if cubic then angle^3 else angle)*base.z on turning against base
}
use std.joints.Revolute
model Pendulum {
    const cubic: Bool = false
    gravity = [0, -9.81, 0] m/s^2
    marker base = [0, 0, 0] mm
    body bob { mass = 1 kg; inertia = [1, 1, 1] g*m^2; center_of_mass = [0, -100, 0] mm; marker pin = origin }
    joint hinge = Revolute(bob.pin, base)
    force spring = Stiffener(bob.pin, base, stiffness: 1 N*m, cubic: cubic)
}
analysis linear_spring = transient(Pendulum(), duration: 1 s)
analysis cubic_spring = transient(Pendulum(cubic: true), duration: 1 s)
";

#[test]
fn a_constant_compiles_only_the_classes_that_it_changes() {
    let run = run_in("/nowhere", "test.eng", TEXT);
    let host = Folder {
        root: "test.eng".to_owned(),
        text: TEXT.to_owned(),
        folder: "/nowhere".into(),
    };
    let (mut sources, mut messages) = (run.sources, Diagnostics::new());
    let plans = analyses(&run.typed, &mut sources, &host, &mut messages);
    let models = SharedModels::default();
    let made = plans.iter().map(|plan| {
        let (model, constants) = (plan.model, &plan.constants);
        let found = models.model(
            &run.typed,
            &mut sources,
            &host,
            model,
            constants,
            &mut messages,
        );
        let model = found.expect("elaborates");
        let code = models.code(&model).expect("compiles");
        (model, code)
    });
    let made: Vec<_> = made.collect();
    assert_eq!(made.len(), 2);
    let of = |index: usize, name: &str| -> &Arc<dyn ElementCode> {
        let (model, code) = &made[index];
        let classes = &model.elaborated.system.classes;
        let at = classes.iter().position(|class| class.name.ends_with(name));
        &code[at.expect("a class of this name")]
    };
    assert!(Arc::ptr_eq(of(0, "Revolute"), of(1, "Revolute")));
    assert!(!Arc::ptr_eq(of(0, "Stiffener"), of(1, "Stiffener")));
}
