//! Time and size of a class's code: `cargo run --release -p eng-compiler --example class_benchmark`.

#[path = "../tests/support/mod.rs"]
mod support;

use eng_compiler::generate::compile_class;
use eng_system::code::{ElementCode, Function, Pair};
use std::hint::black_box;
use std::time::Instant;

/// Nanoseconds for each call, the least of several rounds.
fn time(
    code: &dyn ElementCode,
    function: Function,
    inputs: &[Pair],
    tables: &[eng_system::table::Table],
) -> f64 {
    let mut outputs = vec![[0.0; 2]; code.shape(function).1];
    let calls = 2000;
    (0..20)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..calls {
                code.call(function, black_box(inputs), black_box(&mut outputs), tables);
            }
            start.elapsed().as_secs_f64() * 1e9 / f64::from(calls)
        })
        .fold(f64::INFINITY, f64::min)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let tables = support::tables();
    println!(
        "class     differentiate  generate     bytes  tape | residual, linearize, tangent: ns a pair (interpreter/machine)"
    );
    for case in support::cases() {
        let start = Instant::now();
        let functions = (case.build)(false).functions()?;
        let differentiated = start.elapsed();
        let start = Instant::now();
        let machine = compile_class(&functions, true)?;
        let generated = start.elapsed();
        let interpreter = compile_class(&functions, false)?;
        let mut random = support::Random(1);
        let layout = functions.layout;
        let (a, b) = (
            case.state(&layout, &mut random),
            case.state(&layout, &mut random),
        );
        let common: Vec<Pair> = a.iter().zip(&b).map(|(a, b)| [*a, *b]).collect();
        let mut tape = vec![[0.0; 2]; functions.tape() as usize];
        machine.call(Function::Linearize, &common, &mut tape, &tables);
        tape.extend((0..layout.directions()).map(|_| [random.unit(), random.unit()]));
        print!(
            "{:9} {:10.2} ms {:6.2} ms {:8} {:5} |",
            case.name,
            differentiated.as_secs_f64() * 1e3,
            generated.as_secs_f64() * 1e3,
            machine.code_bytes(),
            functions.tape()
        );
        for (function, inputs) in [
            (Function::Residual, &common),
            (Function::Linearize, &common),
            (Function::Tangent, &tape),
        ] {
            let fast = time(&*machine, function, inputs, &tables);
            let slow = time(&*interpreter, function, inputs, &tables);
            print!("  {fast:7.1} ({:4.1})", slow / fast);
        }
        println!();
    }
    Ok(())
}
