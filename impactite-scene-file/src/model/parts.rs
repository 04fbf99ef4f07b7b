//! Macro for tables of keys.

/// Structs whose fields are the keys of a table; unknown keys are errors.
macro_rules! parts {
    ($($(#[$doc:meta])* $name:ident { $($(#[$inner:meta])* $field:ident: $type:ty,)* })*) => {$(
        #[derive(Clone, Debug, Deserialize, JsonSchema)]
        #[non_exhaustive]
        #[serde(deny_unknown_fields)]
        $(#[$doc])*
        pub struct $name { $($(#[$inner])* pub $field: $type,)* }
    )*};
}
pub(super) use parts;
