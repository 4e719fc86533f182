use super::*;

/// Approximately normal: the sum of twelve uniform numbers.
fn normal(random: &mut SplitMix64) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// Two pipelines on a machine whose load disturbs both, and each frame a little for itself.
fn simulate(rounds: usize, ratio: f64, seed: u64) -> (Timing, Timing) {
    let mut random = SplitMix64(seed);
    let mut a = Vec::new();
    let mut b = Vec::new();
    for _ in 0..rounds {
        let load = 1.0 + 3.0 * random.unit().powi(4);
        b.push(5.0 * load * (0.03 * normal(&mut random)).exp());
        a.push(5.0 * ratio * load * (0.03 * normal(&mut random)).exp());
    }
    (Timing::new(a).unwrap(), Timing::new(b).unwrap())
}

fn steady(n: usize, seed: u64) -> Vec<f64> {
    let mut random = SplitMix64(seed);
    (0..n).map(|_| 4.0 + 0.05 * normal(&mut random)).collect()
}

fn warnings(samples: Vec<f64>) -> Vec<TimingWarning> {
    timing_warnings(&Timing::new(samples).unwrap())
}

#[test]
fn the_interval_holds_the_true_ratio_about_95_times_in_100() {
    let runs = 300;
    let held = (0..runs)
        .filter(|seed| {
            let (a, b) = simulate(40, 1.37, *seed);
            let found = relative_time(&a, &b, "none").unwrap();
            assert!(found.low <= found.median && found.median <= found.high);
            (found.low..=found.high).contains(&1.37)
        })
        .count();
    let share = held as f64 / runs as f64;
    assert!((0.90..=0.99).contains(&share), "{share}");
}

#[test]
fn the_interval_narrows_with_more_rounds() {
    let width = |rounds| {
        let (a, b) = simulate(rounds, 1.2, 5);
        let found = relative_time(&a, &b, "none").unwrap();
        found.high - found.low
    };
    assert!(width(400) < 0.5 * width(20));
}

#[test]
fn shared_load_cancels_in_the_ratio() {
    let (a, b) = simulate(60, 1.5, 11);
    let found = relative_time(&a, &b, "none").unwrap();
    assert!((found.median / 1.5 - 1.0).abs() < 0.02, "{found:?}");
    assert!((found.of_minima / 1.5 - 1.0).abs() < 0.10, "{found:?}");
}

#[test]
fn a_pipeline_is_exactly_as_fast_as_itself() {
    let (a, _) = simulate(30, 1.0, 2);
    let found = relative_time(&a, &a, "itself").unwrap();
    assert_eq!(
        (found.median, found.low, found.high, found.of_minima),
        (1.0, 1.0, 1.0, 1.0)
    );
}

#[test]
fn the_order_of_the_rounds_does_not_move_the_ratio() {
    let (a, b) = simulate(30, 1.3, 4);
    let reversed = |t: &Timing| Timing::new(t.samples.iter().rev().copied().collect()).unwrap();
    let (x, y) = (
        relative_time(&a, &b, "none").unwrap(),
        relative_time(&reversed(&a), &reversed(&b), "none").unwrap(),
    );
    assert_eq!((x.median, x.of_minima), (y.median, y.of_minima));
}

#[test]
fn rounds_must_pair() {
    let (a, _) = simulate(30, 1.0, 2);
    let (b, _) = simulate(29, 1.0, 2);
    assert!(relative_time(&a, &b, "none").is_err());
}

#[test]
fn the_spread_brackets_the_median() {
    let (a, _) = simulate(50, 1.0, 9);
    let f = a.frame_ms();
    assert!(f.min <= f.low && f.low <= f.median && f.median <= f.high);
    assert_eq!(f.samples, a.samples());
}

#[test]
fn no_time_at_all_is_refused() {
    for broken in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let said = Timing::new(vec![1.0, broken]).unwrap_err().to_string();
        assert!(said.starts_with("time of frame 1"), "{said}");
    }
    assert!(Timing::new(Vec::new()).is_err());
}

#[test]
fn a_quiet_machine_raises_no_warning() {
    for seed in 0..20 {
        assert_eq!(warnings(steady(60, seed)), []);
    }
}

#[test]
fn each_trouble_is_named_and_says_what_to_do() {
    let few = warnings(steady(5, 1));
    assert_eq!(few, [TimingWarning::FewSamples { count: 5 }]);

    let mut random = SplitMix64(3);
    let wide = warnings((0..60).map(|_| 1.0 + random.unit()).collect());
    assert!(
        matches!(wide[..], [TimingWarning::WideSpread { .. }]),
        "{wide:?}"
    );

    let coarse = warnings(
        steady(60, 2)
            .iter()
            .map(|s| (s * 20.0).round() / 20.0)
            .collect(),
    );
    assert!(
        matches!(coarse[..], [TimingWarning::CoarseTimer { step_ms, .. }] if (step_ms - 0.05).abs() < 1e-9),
        "{coarse:?}"
    );

    let rising = steady(60, 4).into_iter().enumerate();
    let drift = warnings(rising.map(|(i, s)| s * (1.0 - 0.003 * i as f64)).collect());
    assert!(
        matches!(drift[..], [TimingWarning::Drift { share }] if (share + 0.19).abs() < 0.06),
        "{drift:?}"
    );

    for (warning, remedy) in [
        (few[0], "measure at least 10"),
        (wide[0], "close other programs"),
        (coarse[0], "larger frames"),
        (drift[0], "warm up"),
    ] {
        assert!(warning.to_string().contains(remedy), "{warning}");
    }
}

#[test]
fn one_reading_over_and_over_is_a_coarse_timer() {
    assert!(matches!(
        warnings(vec![2.0; 30])[..],
        [TimingWarning::CoarseTimer { .. }]
    ));
}
