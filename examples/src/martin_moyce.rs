//! Front of a collapsing column of water, experiment \[MartinMoyce1952\].

/// Width a of the column, m; it is twice as high.
pub const WIDTH: f64 = 0.05715;

/// Times t sqrt(2 g / a) and positions x / a of the front \[V\].
pub const FRONT: [[f64; 2]; 15] = [
    [0.41, 1.11],
    [0.84, 1.22],
    [1.19, 1.44],
    [1.43, 1.67],
    [1.63, 1.89],
    [1.83, 2.11],
    [1.98, 2.33],
    [2.20, 2.56],
    [2.32, 2.78],
    [2.51, 3.00],
    [2.65, 3.22],
    [2.83, 3.44],
    [2.98, 3.67],
    [3.11, 3.89],
    [3.33, 4.11],
];
