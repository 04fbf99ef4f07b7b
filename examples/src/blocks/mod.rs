//! Scenes of blocks, bars, discs and balls in contact, shared by the case `bouncing_blocks` and the charts of error against
//! work. They are generic over the method, so that each program compiles only what it runs.

pub mod ball;
pub mod circles;
pub mod discs;
pub mod hertz;
pub mod scene;
pub mod waves;
