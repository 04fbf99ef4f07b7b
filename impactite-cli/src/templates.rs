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
}
