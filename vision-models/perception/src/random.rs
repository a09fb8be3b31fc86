//! Random numbers that a seed repeats.

use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng};

/// One of a seed's streams of random numbers: drawing from one does not change the others.
pub fn generator(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream);
    generator
}
