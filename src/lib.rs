//! Eng: engines as text.
