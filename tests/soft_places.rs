//! Soft joints place a body that nothing else places: their markers coincide at the start.

use crate::library_run::{close, column, run};

const BUSHING: &str = "stiffness: [200, 200, 200] N/mm, damping: [1, 1, 1] kN*s/m,
    torsional_stiffness: [200, 200, 200] N*m/rad, torsional_damping: [1, 1, 1] N*m*s/rad";

/// Beds of the ground: at a distance, turned by right angles, upside down, and turned by any angle about an oblique axis.
const BEDS: [&str; 5] = [
    "[400, 300, 900] mm",
    "at([400, 300, 900] mm, x: [0, 0, 1], z: [1, 0, 0])",
    "at([-200, 0, 100] mm, x: [1, 0, 0], z: [0, 0, -1])",
    "at([-200, 0, 100] mm, x: [-1, 0, 0], z: [0, 0, 1])",
    "at([50, -70, 30] mm, x: [2, 3, 6]/7, z: [6, 2, -3]/7)",
];

/// The places of the body `unit` in the axes of `bed` (m), and the cosines of the angles between their axes.
const OUTPUTS: &str =
    "output off[i in 1..3]: Length = dot(unit.origin.origin - bed.origin, [bed.x, bed.y, bed.z][i])
    output along[i in 1..3]: 1 = dot([unit.origin.x, unit.origin.y, unit.origin.z][i], [bed.x, bed.y, bed.z][i])";

/// The body stands on the bed.
fn stands(text: &str, analysis: &str) {
    let results = run(text, analysis);
    for i in 1..=3 {
        let off = column(&results, &format!("off[{i}]"))[0];
        let along = column(&results, &format!("along[{i}]"))[0];
        assert!(off.abs() < 1e-9, "{off} m along axis {i}: {text}");
        assert!((along - 1.0).abs() < 1e-12, "{along} of axis {i}: {text}");
    }
}

/// A unit on some bushings at its feet.
fn unit(feet: &str, seat: &str, bed: &str, law: &str, stated: &str) -> String {
    format!(
        "use std.forces.Bushing
        model Unit {{
            const feet = {feet}
            gravity = [0, 0, 0] m/s^2
            marker bed = {bed}
            marker seat[k in 1..length(feet)] = at(feet[k], in: bed{seat})
            body unit {{
                mass = 180 kg
                inertia = [9, 16, 14] kg*m^2
                marker foot[k in 1..length(feet)] = feet[k]
                {stated}
            }}
            force mount[k in 1..length(feet)] = Bushing(unit.foot[k], seat[k], {law})
            {OUTPUTS}
        }}
        analysis placed = assemble(Unit())"
    )
}

const ONE: &str = "[[150, -60, 40] mm]";
const THREE: &str = "[[150, 420, 60] mm, [150, -420, 60] mm, [-550, 0, -40] mm]";

/// One bushing states place and axes; three of them agree.
#[test]
fn bushings_place_a_unit_on_any_bed() {
    for bed in BEDS {
        for feet in [ONE, THREE] {
            stands(&unit(feet, "", bed, BUSHING, ""), "placed");
        }
    }
}

/// Mounts that lean to each other have axes that cannot all be parallel to those of the feet: three places decide.
#[test]
fn leaning_mounts_place_a_unit() {
    let lean = ", about: z, by: [45, -45, 0][k]*(1 deg)";
    for bed in BEDS {
        stands(&unit(THREE, lean, bed, BUSHING, ""), "placed");
    }
}

/// A stated position stays, a stated orientation is not turned, and mounts that cannot reach have no influence.
#[test]
fn the_text_has_priority_over_mounts() {
    let bed = BEDS[1];
    let stated = unit(ONE, "", bed, BUSHING, "start position = [7, 8, 9] mm");
    let there = stated.replace(
        OUTPUTS,
        "output off[i in 1..3]: Length = dot(unit.origin.origin, [ground.x, ground.y, ground.z][i])",
    );
    let results = run(&there, "placed");
    for (i, due) in [(1, 7e-3), (2, 8e-3), (3, 9e-3)] {
        close(
            "stated",
            column(&results, &format!("off[{i}]"))[0],
            due,
            1e-12,
        );
    }
    let turned = unit(ONE, "", bed, BUSHING, "start rotation = [0, 0, 30] deg").replace(
        OUTPUTS,
        "output cosine: 1 = dot(unit.origin.x, ground.x)
         output apart: Length = norm(unit.foot[1].origin - seat[1].origin, floor: 1e-12 m)",
    );
    let results = run(&turned, "placed");
    close(
        "cosine",
        column(&results, "cosine")[0],
        30.0_f64.to_radians().cos(),
        1e-12,
    );
    assert!(column(&results, "apart")[0] < 1e-9);
    // feet that are 100 mm farther apart than their seats
    let wide = unit(THREE, "", BEDS[0], BUSHING, "").replace(
        "marker foot[k in 1..length(feet)] = feet[k]",
        "marker foot[k in 1..length(feet)] = feet[k] + [0, [50, -50, 0][k], 0]*(1 mm)",
    );
    let wide = wide.replace("- bed.origin", "");
    let results = run(&wide, "placed");
    for i in 1..=3 {
        assert_eq!(column(&results, &format!("off[{i}]"))[0], 0.0);
    }
}

/// A frame on four bushings, and a unit on three mounts of the frame: one after the other, whatever their order in the text.
#[test]
fn a_unit_stands_on_a_frame_on_bushings() {
    let frame = "body frame { mass = 30 kg; inertia = [1, 1, 2] kg*m^2
            marker corner[k in 1..4] = [300*[1, 1, -1, -1][k], 200*[1, -1, 1, -1][k], 0]*(1 mm)
            marker top = at([0, 0, 80] mm, about: z, by: 90 deg)
            marker seat[k in 1..3] = at(feet[k], in: top) }";
    let unit = "body unit { mass = 180 kg; inertia = [9, 16, 14] kg*m^2; marker foot[k in 1..3] = feet[k] }";
    for bodies in [format!("{frame}\n{unit}"), format!("{unit}\n{frame}")] {
        for bed in BEDS {
            let text = format!(
                "use std.forces.Bushing
                model Stack {{
                    const feet = {THREE}
                    gravity = [0, 0, 0] m/s^2
                    marker base = {bed}
                    marker bed = at([0, 0, 80] mm, in: base, about: z, by: 90 deg)
                    marker post[k in 1..4] = at([300*[1, 1, -1, -1][k], 200*[1, -1, 1, -1][k], 0]*(1 mm), in: base)
                    {bodies}
                    force soft[k in 1..4] = Bushing(frame.corner[k], post[k], {BUSHING})
                    force mount[k in 1..3] = Bushing(unit.foot[k], frame.seat[k], {BUSHING})
                    {OUTPUTS}
                }}
                analysis placed = assemble(Stack())"
            );
            stands(&text, "placed");
        }
    }
}

/// A joint comes before a bushing beside it: the pendulum hangs where its joint puts it.
#[test]
fn a_joint_comes_before_a_bushing() {
    let text = format!(
        "use std.forces.Bushing
        use std.joints.Revolute
        model Arm {{
            gravity = [0, 0, 0] m/s^2
            marker pivot = [0, 0, 0] mm
            marker rest = at([0, 90, 0] mm, about: z, by: 90 deg)
            body arm {{ mass = 1 kg; inertia = [1, 1, 1] g*m^2; marker near = origin; marker far = [100, 0, 0] mm }}
            joint hinge = Revolute(arm.near, pivot)
            force bush = Bushing(arm.far, rest, {BUSHING})
            output angle = hinge.angle as deg
        }}
        analysis placed = assemble(Arm())"
    );
    assert_eq!(column(&run(&text, "placed"), "angle")[0], 0.0);
}

/// A three-cylinder engine on one mount or on three, on beds in any position: its films begin as those of the engine at the origin.
#[test]
fn mounts_place_an_engine() {
    let text = |feet: &str, bed: &str, up: &str| {
        format!(
            "use std.cylinder.{{WeighedRod, diametral}}
            use std.engine.{{Crank, Engine}}
            use std.gas.{{ClosedCycle, wiebe}}
            use std.journals.Impedance
            use std.layouts.inline
            use std.mounts.ElastomerMount
            use std.oils.SAE_5W30
            model Three {{
                const feet = {feet}
                marker bed = {bed}
                marker seat[k in 1..length(feet)] = at(feet[k], in: bed)
                part engine = Engine(
                    layout: inline(throws: [0, 240, 120] deg), order: [1, 3, 2],
                    numbered_from: timing_end, seen_from: timing_end, sense: clockwise,
                    bore: 74 mm, stroke: 82 mm, rod_length: 137 mm, spacing: 82 mm,
                    main_diameter: 48 mm, main_width: 18 mm, main_clearance: diametral(44 um),
                    big_ends: film, pin_diameter: 42 mm, pin_width: 18 mm, pin_clearance: diametral(40 um),
                    law: Impedance, oil: SAE_5W30, oil_temperature: 110 degC,
                    rod: WeighedRod(big_end: 0.32 kg, small_end: 0.13 kg, big_radius: 27 mm, small_radius: 13 mm), piston_mass: 0.33 kg,
                    crankshaft: Crank(mass: 12 kg, inertia: [110, 110, 24] g*m^2),
                    gas: ClosedCycle(stroke: 82 mm, compression_ratio: 10.5, heat: 0.9 kJ, burnt: wiebe(begin: -18 deg, duration: 50 deg)),
                    flywheel_mass: 8 kg, flywheel_inertia: 80 g*m^2, block_mass: 45 kg, block_inertia: [1.2, 1.3, 0.7] kg*m^2,
                    block_is: carried, block_feet: feet, engine_frame: [bed], speed: 3000 rpm, drive_line: constant_speed,
                )
                force mount[k in 1..length(feet)] = ElastomerMount(engine.block.foot[k], seat[k], stiffness: [300, 300, 300] N/mm,
                    fast_stiffness: [400, 400, 400] N/mm, relaxation: 8 ms, torsional_stiffness: [30, 30, 30] kN*m/rad,
                    torsional_damping: [200, 200, 200] N*m*s/rad)
                gravity = {up}*(-9.81 m/s^2)
                output off[i in 1..3]: Length = dot(engine.block.support.origin - bed.origin, [bed.x, bed.y, bed.z][i])
                output along[i in 1..3]: 1 =
                    dot([engine.block.support.x, engine.block.support.y, engine.block.support.z][i], [bed.x, bed.y, bed.z][i])
            }}
            analysis placed = assemble(Three())
            analysis begin = transient(Three(), duration: 5 deg, sample: 1 deg)"
        )
    };
    let one = "[[0, 0, 0] mm]";
    let three = "[[-60, 180, -130] mm, [-60, -180, -130] mm, [-60, 0, 200] mm]";
    // the axes x of the beds
    let ups = [
        "[1, 0, 0]",
        "[0, 0, 1]",
        "[1, 0, 0]",
        "[-1, 0, 0]",
        "[2/7, 3/7, 6/7]",
    ];
    for feet in [one, three] {
        let upright = run(&text(feet, "[0, 0, 0] mm", ups[0]), "begin");
        for (bed, up) in BEDS.into_iter().zip(ups) {
            let text = text(feet, bed, up);
            stands(&text, "placed");
            let there = run(&text, "begin");
            let count = if feet == one { 1 } else { 3 };
            let mounts = (1..=count).map(|k| format!("mount[{k}].deflection"));
            let mains = (1..=4).map(|j| format!("engine.main[{j}].force"));
            for path in mounts.chain(mains) {
                let [due, found] = [&upright, &there].map(|results| {
                    ["x", "y"].map(|axis| column(results, &format!("{path}.{axis}"))[0])
                });
                let size = due[0].hypot(due[1]);
                let off = (due[0] - found[0]).hypot(due[1] - found[1]);
                println!("{bed}: {path}: {off:.1e} of {size:.3e}");
                assert!(off < 1e-3 * size, "{bed}: {path}: {found:?} for {due:?}");
            }
        }
    }
}
