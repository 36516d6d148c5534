//! Every reader of finite-element files reads any bytes, or refuses them with advice.
#![no_main]

use std::io::{self, Cursor, Read};

use eng_flexible::read::matrix::{
    MatrixFormat, MatrixKind, ShapeFormat, read_calculix_freedoms, read_matrix, read_modes,
};
use eng_flexible::reduce::{Request, Term, reduce};
use eng_flexible::solve::Modes;
use eng_flexible::units::MeshUnits;
use eng_flexible::{Files, FlexibleError, Mesh, MeshFormat, read_mesh};
use eng_system::mesh_files::Stated as _;
use libfuzzer_sys::fuzz_target;

/// The only file. No included file exists.
struct Only(Vec<u8>);

impl Files for Only {
    fn open(&self, name: &str) -> io::Result<Box<dyn Read>> {
        match name {
            "file" => Ok(Box::new(Cursor::new(self.0.clone()))),
            _ => Err(io::ErrorKind::NotFound.into()),
        }
    }
}

fn refused(error: &FlexibleError) {
    let (problem, advice) = (error.to_string(), error.advice());
    assert!(!problem.is_empty() && !advice.is_empty(), "{problem}");
}

/// Small meshes are also reduced, so that ties, glue, splines, sections and element rules get what the readers let pass.
const NODES: usize = 150;

fn reduced(mut mesh: Mesh) {
    if mesh.nodes.len() > NODES || mesh.elements.len() > NODES {
        return;
    }
    mesh.convert(&MeshUnits::SI);
    let request = Request {
        terms: vec![Term::Normal {
            modes: Modes::Count(1),
            fixed: Vec::new(),
        }],
        support_of_deck: true,
        damping_up_to: f64::INFINITY,
        ..Request::default()
    };
    match reduce(mesh, &request) {
        Ok(reduced) => assert!(reduced.body.frequencies.iter().all(|f| f.is_finite())),
        // an error inside of the solver may have no advice
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

// Every reader gets the input. So plain files serve as seeds, and a file of another format is tried too.
fuzz_target!(|bytes: &[u8]| {
    let files = Only(bytes.to_vec());
    for (_, format) in MeshFormat::NAMED {
        match read_mesh(&files, "file", *format) {
            Ok(mesh) => {
                for element in &mesh.elements {
                    assert_eq!(mesh.nodes_of(element).len(), element.kind.node_count());
                }
                let mut places = mesh.nodes.iter().flat_map(|node| node.position);
                assert!(places.all(f64::is_finite));
                reduced(mesh);
            }
            Err(error) => refused(&error),
        }
    }
    for (_, format) in MatrixFormat::NAMED {
        match read_matrix(&files, "file", *format, "") {
            Ok(matrix) => {
                for (row, column, value) in &matrix.entries {
                    assert!((*row as usize) < matrix.rows && (*column as usize) < matrix.columns);
                    assert!(value.is_finite());
                }
                // a short file may state a row of many digits; such a matrix would need all memory
                if matrix.rows < 10_000
                    && let Err(error) = matrix.to_symmetric(MatrixKind::Stiffness)
                {
                    refused(&error);
                }
            }
            Err(error) => refused(&error),
        }
    }
    for (_, format) in ShapeFormat::NAMED {
        if let Err(error) = read_modes(&files, "file", *format) {
            refused(&error);
        }
    }
    if let Err(problem) = read_calculix_freedoms(&files, "file") {
        assert!(
            !problem.advice.is_empty() && !problem.problem.is_empty(),
            "{problem}"
        );
    }
});
