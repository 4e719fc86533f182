//! Separable filters on planes of numbers.

/// A filter of odd length along one axis, centred.
pub(super) struct Kernel(pub Vec<f64>);

impl Kernel {
    /// Samples `weight` at whole distances from `-radius` to `radius`.
    pub(super) fn sampled(radius: usize, weight: impl Fn(f64) -> f64) -> Self {
        let radius = radius as i64;
        Self((-radius..=radius).map(|x| weight(x as f64)).collect())
    }

    /// The same kernel with weights that sum to 1.
    pub(super) fn normalised(mut self) -> Self {
        let sum: f64 = self.0.iter().sum();
        for weight in &mut self.0 {
            *weight /= sum;
        }
        self
    }

    /// The same kernel with positive weights that sum to 1 and negative ones that sum to -1.
    pub(super) fn balanced(mut self) -> Self {
        let positive: f64 = self.0.iter().filter(|w| **w > 0.0).sum();
        let negative: f64 = self.0.iter().filter(|w| **w < 0.0).sum();
        for weight in &mut self.0 {
            *weight /= if *weight > 0.0 { positive } else { -negative };
        }
        self
    }
}

/// Filters a plane along x, then along y. Beyond its edge the plane goes on as it ends.
pub(super) fn filtered(
    plane: &[f64],
    size: [usize; 2],
    along_x: &Kernel,
    along_y: &Kernel,
) -> Vec<f64> {
    let rows = along_rows(plane, size, along_x);
    along_columns(&rows, size, along_y)
}

fn along_rows(plane: &[f64], [width, _]: [usize; 2], kernel: &Kernel) -> Vec<f64> {
    let radius = kernel.0.len() / 2;
    let mut out = Vec::with_capacity(plane.len());
    let mut padded = vec![0.0; width + 2 * radius];
    for row in plane.chunks_exact(width) {
        padded[..radius].fill(row[0]);
        padded[radius..radius + width].copy_from_slice(row);
        padded[radius + width..].fill(row[width - 1]);
        out.extend(padded.windows(kernel.0.len()).map(|window| {
            window
                .iter()
                .zip(&kernel.0)
                .map(|(v, w)| v * w)
                .sum::<f64>()
        }));
    }
    out
}

fn along_columns(plane: &[f64], [width, height]: [usize; 2], kernel: &Kernel) -> Vec<f64> {
    let radius = kernel.0.len() / 2;
    let mut out = vec![0.0; plane.len()];
    for (y, row) in out.chunks_exact_mut(width).enumerate() {
        for (i, weight) in kernel.0.iter().enumerate() {
            let from = (y + i).saturating_sub(radius).min(height - 1);
            let source = &plane[from * width..][..width];
            for (sum, value) in row.iter_mut().zip(source) {
                *sum += weight * value;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute_force(plane: &[f64], [w, h]: [usize; 2], kx: &Kernel, ky: &Kernel) -> Vec<f64> {
        let (rx, ry) = ((kx.0.len() / 2) as i64, (ky.0.len() / 2) as i64);
        let mut out = Vec::new();
        for y in 0..h as i64 {
            for x in 0..w as i64 {
                let mut sum = 0.0;
                for j in -ry..=ry {
                    for i in -rx..=rx {
                        let sx = (x + i).clamp(0, w as i64 - 1) as usize;
                        let sy = (y + j).clamp(0, h as i64 - 1) as usize;
                        sum +=
                            plane[sy * w + sx] * kx.0[(i + rx) as usize] * ky.0[(j + ry) as usize];
                    }
                }
                out.push(sum);
            }
        }
        out
    }

    proptest! {
        #[test]
        fn two_passes_equal_the_double_sum(
            (w, h, plane) in (1usize..8, 1usize..8).prop_flat_map(|(w, h)| {
                (Just(w), Just(h), prop::collection::vec(-1.0f64..1.0, w * h))
            }),
            kx in prop::collection::vec(-1.0f64..1.0, 3), ky in prop::collection::vec(-1.0f64..1.0, 7),
        ) {
            let (kx, ky) = (Kernel(kx), Kernel(ky));
            let fast = filtered(&plane, [w, h], &kx, &ky);
            for (a, b) in fast.iter().zip(brute_force(&plane, [w, h], &kx, &ky)) {
                prop_assert!((a - b).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_normalised_kernel_keeps_a_constant_and_a_balanced_one_removes_it() {
        let smooth = Kernel::sampled(3, |x| (-x * x / 2.0).exp()).normalised();
        let slope = Kernel::sampled(3, |x| -x * (-x * x / 2.0).exp()).balanced();
        let plane = vec![0.7; 5 * 4];
        assert!(
            filtered(&plane, [5, 4], &smooth, &smooth)
                .iter()
                .all(|v| (v - 0.7).abs() < 1e-12)
        );
        assert!(
            filtered(&plane, [5, 4], &slope, &smooth)
                .iter()
                .all(|v| v.abs() < 1e-12)
        );
    }
}
