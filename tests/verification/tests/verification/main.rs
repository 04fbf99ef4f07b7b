//! Problems of verification: orders of convergence, elements, statics, heat, smoothed particles, gates.

mod elements;
mod gates;
mod heat;
mod orders;
mod smoothed;
mod statics;
