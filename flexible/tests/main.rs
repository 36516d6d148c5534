//! One program for all files of this folder: each further program would link the whole system again.
//! `cargo test --test all NAME::` runs the tests of the file NAME.
#![allow(missing_docs, clippy::unwrap_used, clippy::expect_used)]

mod abaqus_mutations;
mod abaqus_structure;
mod elastic_surface;
mod element_variants;
mod every_reader;
mod fe_beams;
mod fe_benchmarks;
mod fe_errors;
mod fe_meshes;
mod fe_parts;
mod fe_patch;
mod fe_shell_sections;
mod fe_shells;
mod fe_ties;
mod foreign_doubts;
mod foreign_files;
mod foreign_matrices;
mod foreign_modes;
mod foreign_mutations;
mod geometric;
mod gmsh_files;
mod mesh_formats;
mod modes;
mod nastran_deck;
mod nastran_files;
mod nastran_format;
mod nastran_mesh;
mod nastran_mutations;
mod nastran_structure;
mod recovery;
mod reduce_crank;
mod reduce_errors;
mod reduce_foreign;
mod reduce_interfaces;
mod reduce_solutions;
mod reduce_supports;
mod rotary;
mod shell_meshes;
mod solve_eigen;
mod solve_factor;
mod solve_ordering;
mod store;
mod store_crank;
mod systems;
