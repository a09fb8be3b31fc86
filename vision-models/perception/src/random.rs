//! Reproducible random numbers.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// Returns one of a seed's independent streams of random numbers.
pub(crate) fn generator(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream);
    generator
}
