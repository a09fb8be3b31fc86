//! Streams of random numbers.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Returns one of a seed's independent streams of random numbers, for a camera, a recogniser or a mind.
///
/// ```
/// assert_eq!(simulated_people::generator(1, 0), simulated_people::generator(1, 0));
/// assert_ne!(simulated_people::generator(1, 0), simulated_people::generator(1, 1));
/// ```
pub fn generator(seed: u64, stream: u64) -> ChaCha8Rng {
    let mut generator = ChaCha8Rng::seed_from_u64(seed);
    generator.set_stream(stream);
    generator
}
