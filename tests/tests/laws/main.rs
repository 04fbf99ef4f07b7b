//! Tests of constitutive laws: conformance suite, closed forms, named materials and extreme states. They are separate from the crate
//! of the laws, since optimising a hundred short tests takes longer than running them.

mod closed_forms;
mod composed;
mod conformance;
mod explosives;
mod extreme;
mod failure;
mod flow;
mod ground;
mod library;
mod numbers;
mod plane_stress;
mod tangent;
mod weldox;
