use super::*;
use proptest::prelude::*;

const SIZE: [u32; 2] = [4, 3];
const PIXELS: usize = 12;
const SCENE_M: f64 = 20.0;

/// A frame of which every part can be changed before it is judged.
struct Frame {
    points: [Vec<Seen>; 2],
    projected: [Vec<Option<[f64; 2]>>; 2],
    colours: [Vec<[f32; 3]>; 2],
    water: Vec<bool>,
    undefined: Vec<bool>,
    border_px: u32,
}

impl Frame {
    /// All water, shown as it should be.
    fn perfect() -> Self {
        let points: Vec<Seen> = (0..PIXELS)
            .map(|i| Seen {
                position: [i as f64, 2.0, -1.0],
                object: i as i32 % 3,
            })
            .collect();
        let projected: Vec<_> = (0..PIXELS)
            .map(|i| Some([i as f64 % 4.0 + 0.5, (i / 4) as f64 + 0.5]))
            .collect();
        Self {
            points: [points.clone(), points],
            projected: [projected.clone(), projected],
            colours: [vec![[0.5; 3]; PIXELS], vec![[0.5; 3]; PIXELS]],
            water: vec![true; PIXELS],
            undefined: vec![false; PIXELS],
            border_px: 1,
        }
    }

    fn comparison(&self) -> Comparison<'_> {
        let side = |i: usize| Picture {
            points: &self.points[i],
            projected: &self.projected[i],
            colours: &self.colours[i],
        };
        Comparison {
            size: SIZE,
            border_px: self.border_px,
            scene_diagonal_m: SCENE_M,
            water: &self.water,
            undefined: &self.undefined,
            shown: side(0),
            truth: side(1),
        }
    }

    fn judge(&self) -> Judgement {
        self.comparison().judge().unwrap()
    }

    fn errors(&self) -> Errors {
        self.judge().errors.unwrap()
    }

    fn verdict(&self, i: usize) -> (f64, f64, bool) {
        match self.judge().verdicts[i] {
            Verdict::Error {
                px,
                m,
                wrong_object,
            } => (px, m, wrong_object),
            other => panic!("pixel {i} is not judged: {other:?}"),
        }
    }

    fn swap(&mut self) {
        self.points.swap(0, 1);
        self.projected.swap(0, 1);
        self.colours.swap(0, 1);
    }
}

fn diagonal() -> f64 {
    5.0
}

#[test]
fn the_truth_has_no_error() {
    let e = Frame::perfect().errors();
    assert_eq!((e.position_px.mean, e.position_m.p99), (0.0, 0.0));
    assert_eq!((e.within_half_px, e.wrong_object), (1.0, 0.0));
    assert_eq!((e.rmse, e.psnr), (0.0, crate::MAX_PSNR_DB));
    assert_eq!(e.border.unwrap().within_half_px, 1.0);
}

#[test]
fn a_shifted_point_errs_by_its_distance_in_pixels_and_metres() {
    let mut frame = Frame::perfect();
    frame.points[0][5].position[2] += 0.75;
    frame.projected[0][5] = Some([1.5 + 0.3, 1.5 + 0.4]);
    let (px, m, wrong) = frame.verdict(5);
    assert!((px - 0.5).abs() < 1e-12 && (m - 0.75).abs() < 1e-12 && !wrong);
}

#[test]
fn two_depths_on_one_ray_differ_in_metres_only() {
    let mut frame = Frame::perfect();
    frame.points[0][5].position[2] -= 2.0;
    assert_eq!(frame.verdict(5), (0.0, 2.0, false));
}

#[test]
fn another_object_is_wrong_though_it_may_be_near() {
    let mut frame = Frame::perfect();
    frame.points[0][5].object += 1;
    assert_eq!(frame.verdict(5), (0.0, 0.0, true));
    assert_eq!(frame.errors().wrong_object, 1.0 / 12.0);
}

#[test]
fn a_miss_on_one_side_is_wrong_by_the_diagonal_and_on_both_sides_right() {
    let mut frame = Frame::perfect();
    frame.points[0][5] = Seen::NOTHING;
    assert_eq!(frame.verdict(5), (diagonal(), SCENE_M, true));
    frame.swap();
    assert_eq!(frame.verdict(5), (diagonal(), SCENE_M, true));
    frame.points[0][5] = Seen::NOTHING;
    frame.points[1][5] = Seen::NOTHING;
    assert_eq!(frame.verdict(5), (0.0, 0.0, false));
}

#[test]
fn what_is_not_finite_errs_by_the_diagonal_and_is_counted() {
    for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for side in 0..2 {
            let mut frame = Frame::perfect();
            frame.points[side][5].position[1] = broken;
            assert_eq!(frame.verdict(5), (diagonal(), SCENE_M, false));
            assert_eq!(frame.judge().non_finite_pixels, 1);
            assert_eq!(frame.errors().position_px.mean, diagonal() / 12.0);
        }
    }
}

#[test]
fn a_projection_that_is_missing_or_not_finite_errs_by_the_diagonal() {
    for projection in [None, Some([f64::NAN, 0.0]), Some([0.0, f64::INFINITY])] {
        let mut frame = Frame::perfect();
        frame.points[0][5].position[0] += 1.0;
        frame.projected[0][5] = projection;
        assert_eq!(frame.verdict(5).0, diagonal());
    }
}

#[test]
fn a_texel_with_a_broken_id_is_wrong_even_where_nothing_is_true() {
    for id in [f32::NAN, f32::INFINITY] {
        let mut frame = Frame::perfect();
        frame.points[0][5] = Seen::from_texel([0.0, 0.0, 0.0, id]);
        frame.points[1][5] = Seen::NOTHING;
        assert_eq!(frame.verdict(5), (diagonal(), SCENE_M, true));
    }
    assert_eq!(
        Seen::from_texel([1.0, 2.0, 3.0, 7.0]),
        Seen {
            position: [1.0, 2.0, 3.0],
            object: 7
        }
    );
    assert!(Seen::from_texel([0.0, 0.0, 0.0, -1.0]).misses());
}

#[test]
fn undefined_and_dry_pixels_are_left_out_and_counted() {
    let mut frame = Frame::perfect();
    frame.undefined[0] = true;
    frame.undefined[1] = true;
    frame.water[1] = false;
    frame.points[0][0].position = [f64::NAN; 3];
    frame.points[0][1] = Seen::NOTHING;
    frame.colours[0][0] = [f32::NAN; 3];
    let judgement = frame.judge();
    assert_eq!(judgement.verdicts[0], Verdict::Undefined);
    assert_eq!(judgement.verdicts[1], Verdict::Dry);
    assert_eq!(
        (judgement.water_pixels, judgement.undefined_pixels),
        (11, 1)
    );
    let e = judgement.errors.unwrap();
    assert_eq!((e.position_px.p99, e.wrong_object, e.rmse), (0.0, 0.0, 0.0));
}

#[test]
fn the_border_band_is_judged_for_itself() {
    let mut frame = Frame::perfect();
    // Of 4 x 3 pixels only 5 and 6 are inside a border of one pixel.
    frame.points[0][5] = Seen::NOTHING;
    let e = frame.errors();
    assert_eq!(e.wrong_object, 1.0 / 12.0);
    assert_eq!(e.border.unwrap().wrong_object, 0.0);
    frame.points[0][0] = Seen::NOTHING;
    assert_eq!(frame.errors().border.unwrap().wrong_object, 0.1);
    frame.border_px = 0;
    assert_eq!(frame.errors().border, None);
    frame.border_px = 99;
    assert_eq!(frame.errors().border.unwrap().wrong_object, 1.0 / 6.0);
}

#[test]
fn without_water_there_are_no_figures() {
    let mut frame = Frame::perfect();
    frame.water = vec![false; PIXELS];
    let judgement = frame.judge();
    assert_eq!((judgement.water_pixels, judgement.errors), (0, None));
}

#[test]
fn slices_of_the_wrong_length_are_named() {
    let mut frame = Frame::perfect();
    frame.projected[1].pop();
    let said = frame.comparison().judge().unwrap_err().to_string();
    assert_eq!(
        said,
        "projections of the true points: 11 values where 12 are needed"
    );
    let mut frame = Frame::perfect().comparison().size;
    frame[0] += 1;
    let whole = Frame::perfect();
    assert!(
        Comparison {
            size: frame,
            ..whole.comparison()
        }
        .judge()
        .is_err()
    );
}

proptest! {
    #[test]
    fn every_error_is_finite_capped_and_symmetric(
        bits in prop::collection::vec(any::<[u64; 5]>(), PIXELS),
        ids in prop::collection::vec(-1i32..3, PIXELS),
    ) {
        let mut frame = Frame::perfect();
        for (i, b) in bits.iter().enumerate() {
            let b = b.map(f64::from_bits);
            frame.points[0][i] = Seen { position: [b[0], b[1], b[2]], object: ids[i] };
            frame.projected[0][i] = Some([b[3], b[4]]);
        }
        let there: Vec<_> = (0..PIXELS).map(|i| frame.verdict(i)).collect();
        for (px, m, _) in &there {
            prop_assert!((0.0..=diagonal()).contains(px) && (0.0..=SCENE_M).contains(m));
        }
        let finite = frame.points[0].iter().all(Seen::is_finite);
        frame.swap();
        let back: Vec<_> = (0..PIXELS).map(|i| frame.verdict(i)).collect();
        // A truth that misses may hold anything as its position; a picture that misses may not.
        prop_assert!(!finite || there == back);
    }
}
