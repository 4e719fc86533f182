//! Distances between numbers in units in the last place of `f32`.

/// The spacing of `f32`s at `x`; that of the denormals below 2⁻¹²⁶.
///
/// It is infinite for NaN and infinity.
#[must_use]
pub fn ulp(x: f64) -> f64 {
    if !x.is_finite() {
        return f64::INFINITY;
    }
    // The exponent of the f64, bounded below where f32 becomes denormal.
    let exponent = ((x.to_bits() >> 52) & 0x7FF) as i32 - 1023;
    f64::exp2(f64::from(exponent.max(-126) - 23))
}

/// How far an `f32` is from the number that it should be, in ulps at that number.
///
/// 0 where both are NaN or the same infinity; infinite where only one of them is a finite number.
/// A true value beyond the range of `f32` equals infinity.
#[must_use]
pub fn ulps(found: f32, right: f64) -> f64 {
    let found_is = f64::from(found);
    if found_is.is_nan() && right.is_nan() {
        return 0.0;
    }
    if found.is_finite() && right.is_finite() {
        return (found_is - right).abs() / ulp(right);
    }
    let nearest = right as f32;
    if nearest == found { 0.0 } else { f64::INFINITY }
}

/// An `f32`'s place among all `f32`s in order of size; 0 for both zeros.
///
/// Neighbours differ by 1. NaN has no meaningful place.
#[must_use]
pub fn rank(x: f32) -> i64 {
    let bits = i64::from(x.to_bits());
    if bits & 0x8000_0000 == 0 {
        bits
    } else {
        -(bits & 0x7FFF_FFFF)
    }
}

/// The `f32` at a [`rank`]; infinite beyond the largest.
#[must_use]
pub fn at_rank(rank: i64) -> f32 {
    let most = i64::from(f32::INFINITY.to_bits());
    let bits = rank.unsigned_abs().min(most as u64) as u32;
    let magnitude = f32::from_bits(bits);
    if rank < 0 { -magnitude } else { magnitude }
}
