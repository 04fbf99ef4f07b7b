//! Scene files to begin with: those of the repository's folder `scenes`.

macro_rules! templates {
    ($($name:literal: $what:literal,)*) => {
        /// Name, what it shows, and text.
        pub const TEMPLATES: &[(&str, &str, &str)] =
            &[$(($name, $what, include_str!(concat!("../scenes/", $name, ".toml"))),)*];
    };
}

templates! {
    "taylor_bar": "a copper bar hits a wall; a quarter in three dimensions",
    "rings": "two rubber rings collide",
    "rolling_cylinder": "a cylinder rolls down an incline: friction, gravity over time",
    "pressed_balls": "balls in a container are pressed: repeated bodies, traction",
    "reinforced_bar": "line elements in a bar of concrete: waves of both together",
    "oblique_penetration": "an ogive rod through a plate, obliquely",
    "concrete_perforation": "a rod through concrete, axisymmetric",
    "debris_cloud": "a sphere on a plate at several km/s",
    "tnt": "a detonation",
    "granular_column": "a column of bars collapses",
    "elastic_bar": "a bar on a wall, by the particle-contact method",
    "copper_bar": "a copper bar on a wall, by the particle-contact method",
}
