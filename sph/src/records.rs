//! Particle records for the sums over neighbours: one per particle, then one per image.

/// Records of four numbers: one vector register each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Records<const D: usize> {
    pub particles: usize,
    /// Position of the kernel, m; last: area or volume A, the weight of the particle in sums.
    pub place: Vec<[f64; 4]>,
    /// Velocity, m/s; last: mass, kg.
    pub velocity: Vec<[f64; 4]>,
    /// Smoothing length h, m.
    pub smoothing: Vec<f64>,
    /// Columns of the pair stress minus that of the penalty; in the plane the last two numbers of each column are those of the penalty.
    pub tensor: Vec<[[f64; 4]; D]>,
    /// With a penalty: present position, m (in the plane the last two numbers), and stiffness q of the penalty, Pa (times radius around an
    /// axis).
    pub now: Vec<[f64; 4]>,
    pub bias: Vec<f64>,
    /// With artificial stress: columns of it.
    pub artificial: Vec<[[f64; 4]; D]>,
    /// With balanced artificial stress: columns of the balance, which is subtracted from every pair.
    pub balance: Vec<[[f64; 4]; D]>,
    /// With pair viscosity or density diffusion: density, kg/m^3 (times radius around an axis), and speed of sound, m/s.
    pub fluid: Vec<[f64; 2]>,
    /// With density diffusion: density gradient, kg/m^4; last: density, kg/m^3.
    pub density: Vec<[f64; 4]>,
    /// With density diffusion: true for particles with enough neighbours for a density gradient.
    pub diffuses: Vec<bool>,
}

/// Records that a method requires.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Has {
    pub penalty: bool,
    pub stress: bool,
    pub balance: bool,
    pub viscosity: bool,
    pub diffusion: bool,
}

impl<const D: usize> Records<D> {
    /// Resize the records for `images` images.
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
            self.diffuses.resize(count, true);
        }
    }

    pub fn bytes(&self) -> usize {
        let fours = [&self.place, &self.velocity, &self.now, &self.density];
        let fours: usize = fours.map(|list| list.capacity()).iter().sum();
        let tensors = self.tensor.capacity() + self.artificial.capacity() + self.balance.capacity();
        32 * fours
            + self.diffuses.capacity()
            + tensors * size_of::<[[f64; 4]; D]>()
            + 8 * (self.smoothing.capacity() + self.bias.capacity() + 2 * self.fluid.capacity())
    }
}
