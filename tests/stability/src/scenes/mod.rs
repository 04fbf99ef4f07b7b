//! Stability scenes. Numbers such as T5 refer to the list of the book, "Stability"; others are of this crate.

pub mod conversion;
pub mod crossing;
pub mod crushing;
pub mod elements;
pub mod facets;
pub mod fragile;
pub mod gas;
pub mod limits;
pub mod locking;
pub mod long;
pub mod masses;
pub mod noise;
pub mod shaken;
pub mod smoothed;
pub mod spin;
pub mod stops;
pub mod stretch;
pub mod ties;

use crate::verdict::Scene;

/// List all scenes in order.
pub fn all() -> Vec<Scene> {
    vec![
        crossing::drift(),
        crossing::order(),
        crossing::hypervelocity(),
        crossing::jitter(),
        crossing::thin(),
        limits::cut_cell(),
        limits::predicted(),
        limits::factors(),
        stretch::beads(),
        stretch::drop_out(),
        stretch::tension(),
        noise::null_space(),
        noise::growth(),
        noise::hourglass(),
        locking::beam(),
        locking::pressure(),
        crushing::rubber_crush(),
        crushing::gas_crush(),
        stops::inverted(),
        stops::not_a_number(),
        stops::leaving(),
        stops::debris(),
        masses::tiny(),
        masses::stiff_and_soft(),
        masses::light_and_heavy(),
        long::vibration(),
        spin::disc(),
        spin::size(),
        spin::stress(),
        gas::noh(),
        gas::piston(),
        gas::heating(),
        ties::lattice(),
        ties::threads(),
        elements::point_load(),
        elements::beam(),
        elements::inverted(),
        shaken::balls(),
        facets::leaks(),
        conversion::too_late(),
        conversion::at_a_contact(),
        conversion::at_the_border(),
        conversion::bars_across(),
        smoothed::checkerboard(),
        smoothed::rotation(),
        smoothed::axis(),
        smoothed::rebound(),
        smoothed::rings(),
        smoothed::column(),
        smoothed::blocks(),
        smoothed::alternating_pressure(),
        smoothed::swing(),
        fragile::checkerboard(),
        fragile::stiff_penalty(),
        fragile::alone(),
        fragile::chain(),
        fragile::beam(),
        fragile::flutter(),
        fragile::closed(),
        fragile::slides(),
        fragile::halved(),
    ]
}

/// Scenes of the list that run elsewhere: number, title, location.
pub const ELSEWHERE: [(&str, &str, &str); 6] = [
    (
        "T6",
        "a closing gap: bodies meet where their surfaces are",
        "`mpm-core/tests/contact/onset.rs`, case `ring_collision`",
    ),
    ("T7", "impact and rebound of equal bars", "case `bouncing_blocks`"),
    ("T8", "a light layer under a heavy block, 1e5 steps", "`mpm-core/tests/contact/rest.rs`"),
    ("T18", "a pile at rest, 1e5 steps", "`mpm-core/tests/contact/rest.rs`, case `shaken_discs`"),
    ("T25", "spall of a plate", "case `plate_impact`"),
    (
        "T30",
        "restart and threads: checkpoint at half the steps, threads, grids, observers",
        "`tests/tests/step/restart.rs`, `symmetries.rs`",
    ),
];

/// Scenes of the list for methods that are not available: number, title, missing feature.
pub const MISSING: [(&str, &str, &str); 2] = [
    ("T24", "tank at rest, dam break", "incompressible flow, cure of pressure noise"),
    ("T27", "fragmentation on finer and on turned grids", "nonlocal damage, phase field"),
];
