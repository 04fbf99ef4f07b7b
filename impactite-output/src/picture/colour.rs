//! Colours and perceptually uniform colour maps.

/// Colour: red, green, blue in sRGB.
pub type Rgb = [u8; 3];

/// Colour map. The lightness of all but [`CoolWarm`](Self::CoolWarm) increases monotonically, so that they remain legible in grey
/// print and with colour blindness.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColourMap {
    /// Dark violet, green, yellow: the default.
    #[default]
    Viridis,
    /// Black, red, yellow: temperature, plastic strain, energy.
    Inferno,
    /// Black, violet, cream.
    Magma,
    /// Blue, grey, red: signed quantities. The range is symmetric about 0 unless it is set.
    CoolWarm,
}

/// Seventeen colours per map with linear interpolation; the error is at most 3 % of full scale. The first
/// three are sampled from matplotlib's tables (CC0), the last from Moreland's diverging map.
const TABLES: [[u32; 17]; 4] = [
    [
        0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c, 0x1fa088,
        0x28ae80, 0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725,
    ],
    [
        0x000004, 0x0b0724, 0x210c4a, 0x3d0965, 0x57106e, 0x71196e, 0x8a226a, 0xa32c61, 0xbc3754, 0xd24644,
        0xe45a31, 0xf1731d, 0xf98e09, 0xfcac11, 0xf9cb35, 0xf2ea69, 0xfcffa4,
    ],
    [
        0x000004, 0x0a0822, 0x1d1147, 0x36106b, 0x51127c, 0x6a1c81, 0x832681, 0x9c2e7f, 0xb73779, 0xd0416f,
        0xe75263, 0xf56b5c, 0xfc8961, 0xfea772, 0xfec488, 0xfde2a3, 0xfcfdbf,
    ],
    [
        0x3b4cc0, 0x4e68d8, 0x6282ea, 0x779af7, 0x8db0fe, 0xa3c2fe, 0xb9d0f9, 0xccd9ed, 0xdddcdc, 0xecd3c5,
        0xf5c4ac, 0xf7b093, 0xf4987a, 0xeb7d62, 0xdd5f4b, 0xca3b37, 0xb40426,
    ],
];

impl ColourMap {
    /// Return the colour at `t` between 0 and 1; outside the end colours, grey for NaN.
    #[must_use]
    pub fn at(self, t: f64) -> Rgb {
        if t.is_nan() {
            return NO_VALUE;
        }
        let table = &TABLES[self as usize];
        let place = t.clamp(0.0, 1.0) * 16.0;
        let low = (place.floor() as usize).min(15);
        let part = place - low as f64;
        let (a, b) = (hex(table[low]), hex(table[low + 1]));
        [0, 1, 2].map(|c| (f64::from(a[c]) * (1.0 - part) + f64::from(b[c]) * part).round() as u8)
    }
}

/// Colour of particles without a value: grey.
pub(crate) const NO_VALUE: Rgb = [150, 150, 150];

/// Colours of bodies and curves (after Okabe and Ito, distinguishable with colour blindness).
const PALETTE: [u32; 7] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x4d4d4d];

/// Colour of body or curve `i`; the palette repeats after seven.
#[must_use]
pub fn palette(i: usize) -> Rgb {
    hex(PALETTE[i % PALETTE.len()])
}

/// Convert `0xrrggbb` to a colour.
#[must_use]
pub const fn hex(rgb: u32) -> Rgb {
    [(rgb >> 16) as u8, (rgb >> 8) as u8, rgb as u8]
}
