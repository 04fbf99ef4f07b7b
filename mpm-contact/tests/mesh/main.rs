//! Contact of points with facets: properties of every step, and scenes over many steps.

mod carried;
mod catalogue;
mod energy;
mod fast;
mod laws;
mod penetration;
mod random;
mod scene;
mod search;
mod sliding;
mod speed;
mod turned;
