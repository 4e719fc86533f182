//! Points that a camera sees: inputs that belong to a picture.

use fastrand::Rng;

/// A pinhole camera and a range of depths along its forward direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Where the camera stands, metres.
    pub eye: [f64; 3],
    /// Its axes, at right angles: right, up, forward.
    pub axes: [[f64; 3]; 3],
    /// Half the picture's width and height at unit depth.
    pub half: [f64; 2],
    /// The least and the largest depth, metres.
    pub depths: [f64; 2],
}

impl Picture {
    /// A point: every decade of depth and every place in the picture equally likely.
    pub(super) fn draw(&self, rng: &mut Rng) -> [u32; 3] {
        let [near, far] = self.depths.map(f64::ln);
        let depth = (near + (far - near) * rng.f64()).exp();
        self.point(2.0 * rng.f64() - 1.0, 2.0 * rng.f64() - 1.0, depth)
    }

    /// The middle and the corners of the picture, near and far.
    pub(super) fn special(&self) -> Vec<Vec<u32>> {
        let places = [
            (0.0, 0.0),
            (-1.0, -1.0),
            (1.0, -1.0),
            (-1.0, 1.0),
            (1.0, 1.0),
        ];
        let at = |depth: f64| places.map(|(x, y)| self.point(x, y, depth).to_vec());
        self.depths.into_iter().flat_map(at).collect()
    }

    /// The point itself where it is seen, else one nearby that is.
    pub(super) fn hold(&self, words: &mut [u32]) {
        let number = |i: usize| f64::from(f32::from_bits(words[i]));
        let offset: [f64; 3] = std::array::from_fn(|i| number(i) - self.eye[i]);
        let along = |axis: usize| -> f64 { (0..3).map(|i| self.axes[axis][i] * offset[i]).sum() };
        let [near, far] = self.depths;
        let depth = along(2).clamp(near, far);
        let place = |axis: usize| along(axis) / depth / self.half[axis];
        let (x, y) = (place(0), place(1));
        if !(x.is_finite() && y.is_finite() && depth.is_finite()) {
            words.copy_from_slice(&self.point(0.0, 0.0, near));
        } else if x.abs() > 1.0 || y.abs() > 1.0 || depth != along(2) {
            let inside = self.point(x.clamp(-1.0, 1.0), y.clamp(-1.0, 1.0), depth);
            words.copy_from_slice(&inside);
        }
    }

    /// A point at a place of the picture, from −1 to 1 across and up.
    fn point(&self, x: f64, y: f64, depth: f64) -> [u32; 3] {
        let [right, up, forward] = &self.axes;
        let (x, y) = (x * self.half[0], y * self.half[1]);
        std::array::from_fn(|i| {
            let offset = right[i] * x + up[i] * y + forward[i];
            ((self.eye[i] + depth * offset) as f32).to_bits()
        })
    }
}
