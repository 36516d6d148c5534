//! A class as an element of an elaborated model: its code, generated and interpreted, and its numbers.

use super::catalogue::{CASES, Case};
use eng_compiler::elaborate::{Elaborated, analyses, elaborate};
use eng_compiler::generate::compile_class;
use eng_compiler::ir::{ClassBody, ClassFunctions};
use eng_compiler::library::LIBRARY;
use eng_compiler::resolve::resolve;
use eng_grammar::{Diagnostics, SourceMap};
use eng_system::code::{BindCode, ElementCode};
use eng_system::host::{Host, HostError};
use eng_system::layout::InputLayout;
use eng_system::system::{BodyRef, OutputInfo};
use eng_system::table::Table;
use std::sync::Arc;

struct Text(String);

impl Host for Text {
    fn read_text(&self, path: &str) -> Result<String, HostError> {
        (path == "pair.eng")
            .then(|| self.0.clone())
            .ok_or_else(|| HostError::NotFound(path.into()))
    }
}

/// A marker of the element: path, body, place on it.
pub struct Place {
    pub path: String,
    pub body: BodyRef,
    pub position: [f64; 3],
    /// Marker → body, row-major.
    pub orientation: [f64; 9],
}

/// The element `it` of a case's model.
pub struct Instance {
    pub case: &'static Case,
    pub layout: InputLayout,
    pub body: ClassBody,
    pub functions: ClassFunctions,
    pub machine: Arc<dyn ElementCode>,
    pub interpreter: Arc<dyn ElementCode>,
    pub constants: Vec<f64>,
    pub places: Vec<Place>,
    /// The constraint equations as written.
    pub rows: Vec<String>,
    pub outputs: Vec<OutputInfo>,
    pub tables: Vec<Table>,
}

fn elaborated(text: String) -> Elaborated {
    let host = Text(text);
    let (mut sources, mut diagnostics) = (SourceMap::new(), Diagnostics::new());
    let program = resolve("pair.eng", &host, LIBRARY, &mut sources, &mut diagnostics);
    let typed = eng_compiler::check::check(program, &sources, &mut diagnostics);
    let plans = analyses(&typed, &mut sources, &host, &mut diagnostics);
    let made = plans.first().and_then(|plan| {
        elaborate(
            &typed,
            &mut sources,
            &host,
            plan.model,
            &plan.constants,
            &mut diagnostics,
        )
    });
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{}: {errors:#?}", host.0);
    made.expect("a system")
}

impl Instance {
    pub fn new(case: &'static Case) -> Instance {
        let made = elaborated(case.text());
        let slots = made
            .bind
            .bind(
                &vec![None; made.system.parameters.len()],
                &made.system.tables,
            )
            .expect("the numbers fit")
            .slots;
        let slot = |s: &eng_system::system::Slot| slots[s.0 as usize];
        let element = made
            .system
            .elements
            .iter()
            .find(|e| e.origin.path == "it")
            .expect("the element");
        let index = element.class as usize;
        let class = &made.system.classes[index];
        assert_eq!(class.name, case.class);
        let functions = made.classes[index].clone();
        let places = element
            .markers
            .iter()
            .map(|m| {
                let marker = &made.system.markers[*m as usize];
                Place {
                    path: marker.origin.path.clone(),
                    body: marker.body,
                    position: marker.position.each_ref().map(slot),
                    orientation: marker.orientation.each_ref().map(slot),
                }
            })
            .collect();
        Instance {
            case,
            layout: class.layout,
            body: made.bodies[index].clone(),
            machine: compile_class(&functions, true).expect("compiles"),
            interpreter: compile_class(&functions, false).expect("is ready"),
            functions,
            constants: element.constants.iter().map(slot).collect(),
            places,
            rows: class.rows.iter().map(|r| r.text.clone()).collect(),
            outputs: class.outputs.clone(),
            tables: made.system.tables.clone(),
        }
    }

    /// Every case of the catalogue.
    pub fn all() -> impl Iterator<Item = Instance> {
        CASES.iter().map(Instance::new)
    }

    /// Index of the marker with a path.
    pub fn marker(&self, path: &str) -> Option<usize> {
        self.places.iter().position(|p| p.path == path)
    }

    /// Index of an output.
    pub fn output(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|o| o.name == name)
    }
}
