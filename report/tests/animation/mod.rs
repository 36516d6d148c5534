//! Animations and their parts.

mod collapse;
mod film;
mod image;
mod packed;
mod poster;
mod quaternion;
mod solid;
mod viewer;
mod vtk;
