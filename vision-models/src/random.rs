//! Random numbers that are the same on every machine.

use rand_chacha::{ChaCha8Rng, rand_core::RngCore};

/// Returns a number in [0, 1) from the upper 53 bits.
pub(crate) fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Puts the numbers in random order (Knuth, "The Art of Computer Programming" 2, 3.4.2, algorithm P).
pub(crate) fn shuffle(order: &mut [usize], random: &mut ChaCha8Rng) {
    for last in (1..order.len()).rev() {
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Below the length.
        let other = (uniform(random) * (last + 1) as f64) as usize;
        order.swap(last, other.min(last));
    }
}
