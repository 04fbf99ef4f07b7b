//! Scene files: keys, units, refusals, random changes, estimates, answers.

mod answers;
mod book;
mod estimate;
mod keys;
mod limits;
mod mutations;
mod random;
mod refine;
mod refused;
mod units;
