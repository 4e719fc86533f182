//! Frames of several pipelines, interleaved.

/// How often pipelines are rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rounds {
    /// Rounds that are not counted, first.
    pub warm_up: u32,
    /// Rounds that are counted; every pipeline renders one frame a round.
    pub counted: u32,
}

impl Default for Rounds {
    fn default() -> Self {
        Self {
            warm_up: 2,
            counted: 15,
        }
    }
}

/// The order of the pipelines in a round: a different one each time, the same in every run.
pub(crate) fn order(round: u32, count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    let mut state = u64::from(round) ^ 0x9e37_79b9_7f4a_7c15;
    for index in (1..count).rev() {
        // Knuth's linear congruential generator; its high bits choose.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        order.swap(index, (state >> 33) as usize % (index + 1));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::order;

    #[test]
    fn every_round_renders_all_in_an_order_of_its_own() {
        let rounds: Vec<_> = (0..20).map(|round| order(round, 6)).collect();
        for order in &rounds {
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3, 4, 5]);
        }
        assert!(rounds.iter().any(|o| *o != rounds[0]));
        assert_eq!(rounds[3], order(3, 6));
    }
}
