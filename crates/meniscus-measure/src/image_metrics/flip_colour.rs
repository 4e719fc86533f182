//! The colour spaces of FLIP.
//!
//! All are relative to sRGB's own white, which is (1, 1, 1) in linear light.

/// Linear sRGB to CIE XYZ, solved without rounding from the chromaticities of sRGB's primaries and of
/// D65 to five digits (x 0.31271, y 0.32902).
const TO_XYZ: [[f64; 3]; 3] = [
    [
        10_135_552.0 / 24_577_794.0,
        8_788_810.0 / 24_577_794.0,
        4_435_075.0 / 24_577_794.0,
    ],
    [
        2_613_072.0 / 12_288_897.0,
        8_788_810.0 / 12_288_897.0,
        887_015.0 / 12_288_897.0,
    ],
    [
        1_425_312.0 / 73_733_382.0,
        8_788_810.0 / 73_733_382.0,
        70_074_185.0 / 73_733_382.0,
    ],
];

fn product(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// Inverts a matrix by its adjugate; only for the well-conditioned one above.
fn inverse(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let minor = |r: usize, c: usize| {
        let (r1, r2) = ((r + 1) % 3, (r + 2) % 3);
        let (c1, c2) = ((c + 1) % 3, (c + 2) % 3);
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    std::array::from_fn(|r| std::array::from_fn(|c| minor(c, r) / determinant))
}

/// Conversions between linear sRGB and the opponent spaces.
pub(super) struct Spaces {
    white: [f64; 3],
    from_xyz: [[f64; 3]; 3],
}

impl Spaces {
    pub(super) fn new() -> Self {
        Self {
            white: product(&TO_XYZ, [1.0; 3]),
            from_xyz: inverse(&TO_XYZ),
        }
    }

    /// CIE XYZ with the white at (1, 1, 1).
    fn relative_xyz(&self, linear: [f64; 3]) -> [f64; 3] {
        let xyz = product(&TO_XYZ, linear);
        std::array::from_fn(|i| xyz[i] / self.white[i])
    }

    /// Linear sRGB to YCxCz, the linearised CIELAB in which contrast sensitivity is applied.
    pub(super) fn opponent(&self, linear: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.relative_xyz(linear);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// YCxCz back to linear sRGB.
    pub(super) fn linear(&self, [y, cx, cz]: [f64; 3]) -> [f64; 3] {
        let y = (y + 16.0) / 116.0;
        let relative = [y + cx / 500.0, y, y - cz / 200.0];
        product(
            &self.from_xyz,
            std::array::from_fn(|i| relative[i] * self.white[i]),
        )
    }

    /// Linear sRGB to CIELAB.
    pub(super) fn lab(&self, linear: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.relative_xyz(linear).map(|t| {
            let delta = 6.0 / 29.0f64;
            if t > delta.powi(3) {
                t.cbrt()
            } else {
                t / (3.0 * delta * delta) + 4.0 / 29.0
            }
        });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// Linear sRGB to CIELAB with less colour the darker it is (the Hunt effect).
    pub(super) fn hunt_lab(&self, linear: [f64; 3]) -> [f64; 3] {
        let [l, a, b] = self.lab(linear);
        [l, 0.01 * l * a, 0.01 * l * b]
    }

    /// Luminance of a linear colour, white being 1.
    pub(super) fn luminance(&self, linear: [f64; 3]) -> f64 {
        product(&TO_XYZ, linear)[1]
    }
}

/// The HyAB distance: lightness and chroma apart (Abasi, Amani Tehran, Fairchild 2020).
pub(super) fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_neutral_and_as_light_as_it_gets() {
        let spaces = Spaces::new();
        for lab in [spaces.lab([1.0; 3]), spaces.opponent([1.0; 3])] {
            assert!((lab[0] - 100.0).abs() < 1e-12 && lab[1].abs() < 1e-12 && lab[2].abs() < 1e-12);
        }
        assert!(spaces.lab([0.0; 3]).iter().all(|c| c.abs() < 1e-12));
    }

    #[test]
    fn primaries_and_white_have_their_chromaticities() {
        for (colour, x, y) in [
            ([1.0, 0.0, 0.0], 0.64, 0.33),
            ([0.0, 1.0, 0.0], 0.30, 0.60),
            ([0.0, 0.0, 1.0], 0.15, 0.06),
            ([1.0, 1.0, 1.0], 0.31271, 0.32902),
        ] {
            let xyz = product(&TO_XYZ, colour);
            let sum: f64 = xyz.iter().sum();
            assert!((xyz[0] / sum - x).abs() < 1e-9 && (xyz[1] / sum - y).abs() < 1e-9);
        }
    }

    #[test]
    fn opponent_colours_lead_back() {
        let spaces = Spaces::new();
        for colour in [[0.2, 0.7, 0.05], [1.0, 0.0, 0.0], [0.0, 0.3, 1.0]] {
            let back = spaces.linear(spaces.opponent(colour));
            assert!(colour.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    #[test]
    fn the_two_pieces_of_lab_meet() {
        let spaces = Spaces::new();
        let edge = (6.0f64 / 29.0).powi(3);
        let [below, above] =
            [edge * (1.0 - 1e-9), edge * (1.0 + 1e-9)].map(|t| spaces.lab([t; 3])[0]);
        assert!((below - above).abs() < 1e-6);
    }

    #[test]
    fn hyab_is_a_distance() {
        let (a, b, c) = ([50.0, 10.0, -5.0], [20.0, -3.0, 8.0], [90.0, 0.0, 30.0]);
        assert_eq!(hyab(a, a), 0.0);
        assert_eq!(hyab(a, b), hyab(b, a));
        assert!(hyab(a, c) <= hyab(a, b) + hyab(b, c));
    }
}
