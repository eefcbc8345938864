//! Numbers that look random and are the same everywhere.

/// Smooth noise from 0 to 1 with features of size 1.
pub fn noise(x: f64, y: f64) -> f64 {
    let [i, j] = [x.floor(), y.floor()];
    let [s, t] = [x - i, y - j].map(|f| f * f * (3.0 - 2.0 * f));
    let row = |j: f64| random(i, j) + s * (random(i + 1.0, j) - random(i, j));
    row(j) + t * (row(j + 1.0) - row(j))
}

/// A number from 0 to 1 for a pair of whole numbers.
pub fn random(i: f64, j: f64) -> f64 {
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "wrapping is meant"
    )]
    let [i, j] = [i, j].map(|x| x as i64 as u64);
    let mut bits = i.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ j.wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    bits = (bits ^ (bits >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 29)).wrapping_mul(0x94d0_49bb_1331_11eb);
    #[expect(clippy::cast_precision_loss, reason = "53 bits are kept")]
    let value = (bits >> 11) as f64 / (1_u64 << 53) as f64;
    value
}
