//! A C program that uses the library, compiled by the system's compiler.

use eng::{Quantity, Sources};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The library beside this test program.
pub fn library() -> PathBuf {
    let program = std::env::current_exe().expect("the test program");
    let name = format!(
        "{}eng_c{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    let library = program.with_file_name(name);
    assert!(library.is_file(), "{} is missing", library.display());
    library
}

/// A new folder of a test.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Times and speeds (rad/s) of the same controller in Rust.
fn expected() -> Vec<String> {
    let sources = Sources::from_text("rotor.eng", crate::ROTOR);
    let program = eng::check(&sources, "rotor.eng")
        .into_program()
        .expect("a program");
    let model = program.model("Rotor").expect("a model");
    let inertia = model.parameter("inertia").expect("a parameter");
    let dimension = model.describe(inertia).expect("its own").dimension;
    let builder = model
        .simulation()
        .set(inertia, Quantity::si(0.05, dimension));
    let mut simulation = builder
        .and_then(|builder| builder.start())
        .expect("a start");
    let brake = model.input("brake").expect("an input");
    let speed = model.channel("speed").expect("a channel");
    let mut lines = Vec::new();
    for step in 0..100 {
        let now = simulation.value(speed).expect("a value");
        simulation
            .set_input(brake, (0.5 * (now - 60.0)).clamp(0.0, 40.0))
            .expect("within limits");
        simulation
            .advance(0.01 * f64::from(step + 1))
            .expect("a step");
        lines.push([simulation.time().to_bits(), now.to_bits()]);
    }
    let end = simulation.value(speed).expect("a value").to_bits();
    lines.push([end, end]);
    lines.iter().map(|bits| format!("{bits:x?}")).collect()
}

#[test]
fn a_c_program_gets_the_bits_of_rust() {
    let folder = folder("from_c");
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let library = library();
    let program = folder.join("rotor");
    let compiler = std::env::var_os("CC").unwrap_or_else(|| "cc".into());
    let built = Command::new(compiler)
        .args(["-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-I"])
        .arg(here.join("include"))
        .arg(here.join("tests/rotor.c"))
        .arg(&library)
        .arg("-o")
        .arg(&program)
        .output()
        .expect("a C compiler");
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );

    let run = Command::new(&program)
        .arg(here.join("tests/rotor.eng"))
        .current_dir(&folder)
        .env("LD_LIBRARY_PATH", library.parent().expect("a folder"))
        .env("ENG_CACHE", "")
        .output()
        .expect("the program runs");
    let output = String::from_utf8(run.stdout).expect("a text");
    assert!(
        run.status.success(),
        "{output}{}",
        String::from_utf8_lossy(&run.stderr)
    );

    let mut lines = output.lines();
    assert_eq!(lines.next(), Some("unit kg*m^2/s^2"));
    let numbers = |line: &str| {
        let numbers = line.split(' ').filter_map(|word| word.parse::<f64>().ok());
        numbers.map(f64::to_bits).collect::<Vec<u64>>()
    };
    let shown = |line: &str| format!("{:x?}", numbers(line));
    let mut found: Vec<String> = lines.by_ref().take(100).map(shown).collect();
    assert_eq!(lines.next(), Some("resumed at 0.5"));
    found.extend(lines.next().map(shown));
    assert_eq!(found, expected());

    let messages: Vec<&str> = lines.collect();
    let messages = messages.join("\n");
    let wanted = [
        "there is no channel sped; did you mean speed?",
        "the simulation has started",
        "outside its limits",
        "there is no input 7: the model has 1, and the first is 0",
        "time goes forward: from 1 s the simulation cannot advance to 0.5 s",
        "the values are a null pointer",
        "the simulation is a null pointer",
        "no.eng",
    ];
    let refused: Vec<&str> = messages.split("refused: ").skip(1).collect();
    assert_eq!(refused.len(), wanted.len(), "{messages}");
    for (message, wanted) in refused.iter().zip(wanted) {
        assert!(message.contains(wanted), "{message}\n{wanted}");
    }
}
