//! What neighbours read of each other: a record a particle, then one an image.

/// Records of four numbers, so that one vector holds one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Records<const D: usize> {
    pub particles: usize,
    /// Where kernels are taken, m; last, the area or volume A that a neighbour has in sums.
    pub place: Vec<[f64; 4]>,
    /// m/s; last the mass, kg.
    pub velocity: Vec<[f64; 4]>,
    /// The smoothing length h, m.
    pub smoothing: Vec<f64>,
    /// Columns of the stress that acts on pairs, less those of the penalty; in the plane those of the penalty are the last two of each.
    pub tensor: Vec<[[f64; 4]; D]>,
    /// With a penalty: where particles are, m (in the plane the last two numbers), and its stiffness q, Pa (times radius around an axis).
    pub now: Vec<[f64; 4]>,
    pub bias: Vec<f64>,
    /// With artificial stress: its columns.
    pub artificial: Vec<[[f64; 4]; D]>,
    /// And, where that is balanced, columns of what is taken off of every pair.
    pub balance: Vec<[[f64; 4]; D]>,
    /// With a viscosity of pairs or a diffusion of density: density, kg/m^3 (times radius around an axis), and speed of sound, m/s.
    pub fluid: Vec<[f64; 2]>,
    /// With a diffusion of density: its gradient, kg/m^4; last the density, kg/m^3.
    pub density: Vec<[f64; 4]>,
}

/// Which of them a method has.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Has {
    pub penalty: bool,
    pub stress: bool,
    pub balance: bool,
    pub viscosity: bool,
    pub diffusion: bool,
}

impl<const D: usize> Records<D> {
    /// Have room for so many images.
    pub fn resize(&mut self, images: usize, has: Has) {
        let count = self.particles + images;
        self.place.resize(count, [0.0; 4]);
        self.velocity.resize(count, [0.0; 4]);
        self.smoothing.resize(count, 0.0);
        self.tensor.resize(count, [[0.0; 4]; D]);
        if has.penalty {
            self.now.resize(count, [0.0; 4]);
            self.bias.resize(count, 0.0);
        }
        if has.stress {
            self.artificial.resize(count, [[0.0; 4]; D]);
        }
        if has.balance {
            self.balance.resize(count, [[0.0; 4]; D]);
        }
        if has.viscosity || has.diffusion {
            self.fluid.resize(count, [0.0; 2]);
        }
        if has.diffusion {
            self.density.resize(count, [0.0; 4]);
        }
    }

    pub fn bytes(&self) -> usize {
        let fours = [&self.place, &self.velocity, &self.now, &self.density];
        let fours: usize = fours.map(|list| list.capacity()).iter().sum();
        let tensors = self.tensor.capacity() + self.artificial.capacity() + self.balance.capacity();
        32 * fours
            + tensors * size_of::<[[f64; 4]; D]>()
            + 8 * (self.smoothing.capacity() + self.bias.capacity() + 2 * self.fluid.capacity())
    }
}
