//! Constitutive laws for tests that make a property visible.

use mpm_materials::{
    Breakdown, Constitutive, Fault, Kinematics, Lane, LinearElastic, Sym3, Update, elastic::HypoelasticState,
    state,
};

use crate::scene;

/// Linear elasticity with an initial stress.
#[derive(Clone, Debug)]
pub struct Prestressed {
    elastic: LinearElastic<f64>,
    stress: [f64; 6],
}

impl Prestressed {
    /// Create the law with this initial stress: xx, yy, zz, yz, xz, xy.
    pub fn new(stress: [f64; 6]) -> Self {
        Prestressed { elastic: scene::metal(), stress }
    }
}

impl Constitutive<f64> for Prestressed {
    type State<L: Lane<Real = f64>> = HypoelasticState<L>;
    fn name(&self) -> &'static str {
        "prestressed"
    }
    fn density(&self) -> f64 {
        self.elastic.density()
    }
    fn virgin(&self) -> HypoelasticState<f64> {
        HypoelasticState { stress: Sym3(self.stress), volume_ratio: 1.0 }
    }
    #[inline(always)]
    fn update<L: Lane<Real = f64>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &HypoelasticState<L>,
    ) -> Update<L, HypoelasticState<L>> {
        self.elastic.update(kinematics, old)
    }
    #[inline(always)]
    fn stress<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> Sym3<L> {
        now.stress
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> L {
        now.volume_ratio
    }
    #[inline(always)]
    fn wave_speed<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> L {
        self.elastic.wave_speed(now)
    }
    #[inline(always)]
    fn energy<L: Lane<Real = f64>>(&self, now: &HypoelasticState<L>) -> L {
        self.elastic.energy(now)
    }
}

state! {
    /// Elastic state, and state variables with fixed ratios as long as a particle's variables are not mixed with
    /// another's.
    pub struct Ledger<L> {
        /// Elastic state.
        pub elastic: HypoelasticState<L>,
        /// Sum of all xx strain increments.
        pub one: L,
        /// Twice `one`.
        pub two: L,
        /// Four times `one`.
        pub four: L,
        /// Number of steps.
        pub age: L,
        /// Minus eight times `one`.
        pub minus_eight: L,
    }
}

/// Linear elasticity with a [`Ledger`]; it fails where the sum of xx strain increments exceeds a limit.
#[derive(Clone, Debug)]
pub struct Watched {
    elastic: LinearElastic<f64>,
    limit: f64,
}

impl Watched {
    /// Create a law that fails above `limit`.
    pub fn new(limit: f64) -> Self {
        Watched { elastic: scene::metal(), limit }
    }
}

impl Constitutive<f64> for Watched {
    type State<L: Lane<Real = f64>> = Ledger<L>;
    fn name(&self) -> &'static str {
        "watched"
    }
    fn density(&self) -> f64 {
        self.elastic.density()
    }
    fn virgin(&self) -> Ledger<f64> {
        let elastic = self.elastic.virgin();
        Ledger { elastic, one: 0.0, two: 0.0, four: 0.0, age: 0.0, minus_eight: 0.0 }
    }
    #[inline(always)]
    fn update<L: Lane<Real = f64>>(
        &self,
        kinematics: &Kinematics<L>,
        old: &Ledger<L>,
    ) -> Update<L, Ledger<L>> {
        let new = self.elastic.update(kinematics, &old.elastic);
        let strain = kinematics.increment.0[0][0];
        let state = Ledger {
            elastic: new.state,
            one: old.one + strain,
            two: old.two + strain * L::of(2.0),
            four: old.four + strain * L::of(4.0),
            age: old.age + L::one(),
            minus_eight: old.minus_eight - strain * L::of(8.0),
        };
        let fault = Fault::none().require(state.one.le(L::of(self.limit)), Breakdown::Law);
        Update { state, stress: new.stress, fault: new.fault.or(fault) }
    }
    #[inline(always)]
    fn stress<L: Lane<Real = f64>>(&self, now: &Ledger<L>) -> Sym3<L> {
        now.elastic.stress
    }
    #[inline(always)]
    fn volume_ratio<L: Lane<Real = f64>>(&self, now: &Ledger<L>) -> L {
        now.elastic.volume_ratio
    }
    #[inline(always)]
    fn wave_speed<L: Lane<Real = f64>>(&self, now: &Ledger<L>) -> L {
        self.elastic.wave_speed(&now.elastic)
    }
    #[inline(always)]
    fn energy<L: Lane<Real = f64>>(&self, now: &Ledger<L>) -> L {
        self.elastic.energy(&now.elastic)
    }
}
