//! Shapes, seeding, meshes and their files, neighbour search.

#[cfg(feature = "mesh")]
mod abaqus_files;
mod elements;
mod mesh;
#[cfg(feature = "mesh")]
mod mesh_files;
mod search;
mod seeding;
mod shapes;
mod structured;
#[cfg(feature = "mesh")]
mod surface_files;
