//! Four numbers at a time.

/// Four numbers that one instruction works on, where the machine has one.
pub(super) trait Lanes: Copy {
    fn splat(value: f64) -> Self;
    fn load(from: &[f64; 4]) -> Self;
    /// Loads up to four numbers from the start of a slice, followed by zeros.
    fn load_part(from: &[f64]) -> Self;
    fn store(self, to: &mut [f64; 4]);
    /// self · b + c.
    fn multiply_add(self, b: Self, c: Self) -> Self;
    fn sum(self) -> f64;
    /// Returns, as one bit each, which numbers are outside their bounds.
    fn outside(self, lower: Self, upper: Self) -> u64;

    /// Returns the sums of four values.
    fn sums(four: [Self; 4]) -> [f64; 4] {
        four.map(Self::sum)
    }
}

/// Portable implementation for every machine.
#[derive(Debug, Clone, Copy)]
pub(super) struct Portable([f64; 4]);

impl Lanes for Portable {
    fn splat(value: f64) -> Self {
        Self([value; 4])
    }

    fn load(from: &[f64; 4]) -> Self {
        Self(*from)
    }

    fn load_part(from: &[f64]) -> Self {
        Self(std::array::from_fn(|i| from.get(i).copied().unwrap_or(0.0)))
    }

    fn store(self, to: &mut [f64; 4]) {
        *to = self.0;
    }

    fn multiply_add(self, b: Self, c: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] * b.0[i] + c.0[i]))
    }

    fn sum(self) -> f64 {
        (self.0[0] + self.0[2]) + (self.0[1] + self.0[3])
    }

    fn outside(self, lower: Self, upper: Self) -> u64 {
        (0..4).fold(0, |bits, i| {
            bits | u64::from(self.0[i] < lower.0[i] || self.0[i] > upper.0[i]) << i
        })
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::Avx2;

#[cfg(target_arch = "x86_64")]
mod x86 {
    #![allow(unsafe_code)]
    #![expect(clippy::inline_always, reason = "takes the features of the function around it")]

    use super::Lanes;
    use std::arch::x86_64::{
        __m256d, _CMP_GT_OQ, _CMP_LT_OQ, _mm_add_pd, _mm_add_sd, _mm_cvtsd_f64, _mm_unpackhi_pd,
        _mm256_add_pd, _mm256_castpd_si256, _mm256_castpd256_pd128, _mm256_cmp_pd,
        _mm256_extractf128_pd, _mm256_fmadd_pd, _mm256_hadd_pd, _mm256_loadu_pd,
        _mm256_maskload_pd, _mm256_movemask_pd, _mm256_or_pd, _mm256_permute2f128_pd,
        _mm256_set1_pd, _mm256_storeu_pd,
    };

    /// Implementation for AVX2 with fused multiply-add. Values may be created only where both are
    /// known to exist.
    #[derive(Debug, Clone, Copy)]
    pub(in crate::linalg::kernels) struct Avx2(__m256d);

    impl Lanes for Avx2 {
        #[inline(always)]
        fn splat(value: f64) -> Self {
            // SAFETY: the machine has AVX (see the type).
            Self(unsafe { _mm256_set1_pd(value) })
        }

        #[inline(always)]
        fn load(from: &[f64; 4]) -> Self {
            // SAFETY: the machine has AVX (see the type). The four numbers read belong to `from`,
            // and the instruction requires no alignment.
            Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
        }

        #[inline(always)]
        fn load_part(from: &[f64]) -> Self {
            const ALL: f64 = f64::from_bits(u64::MAX);
            const MASKS: [[f64; 4]; 5] = [
                [0.0; 4],
                [ALL, 0.0, 0.0, 0.0],
                [ALL, ALL, 0.0, 0.0],
                [ALL, ALL, ALL, 0.0],
                [ALL; 4],
            ];
            let mask = &MASKS[from.len().min(4)];
            // SAFETY: the machine has AVX (see the type). The mask is four numbers. Only those
            // numbers of `from` are read for which the mask is set. Neither load requires
            // alignment.
            unsafe {
                let mask = _mm256_castpd_si256(_mm256_loadu_pd(mask.as_ptr()));
                Self(_mm256_maskload_pd(from.as_ptr(), mask))
            }
        }

        #[inline(always)]
        fn store(self, to: &mut [f64; 4]) {
            // SAFETY: the machine has AVX (see the type). The four numbers written belong to `to`,
            // and the instruction requires no alignment.
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) };
        }

        #[inline(always)]
        fn multiply_add(self, b: Self, c: Self) -> Self {
            // SAFETY: the machine has fused multiply-add (see the type).
            Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) })
        }

        #[inline(always)]
        fn sum(self) -> f64 {
            // SAFETY: the machine has AVX (see the type).
            unsafe {
                let low = _mm256_castpd256_pd128(self.0);
                let two = _mm_add_pd(low, _mm256_extractf128_pd::<1>(self.0));
                _mm_cvtsd_f64(_mm_add_sd(two, _mm_unpackhi_pd(two, two)))
            }
        }

        #[inline(always)]
        fn outside(self, lower: Self, upper: Self) -> u64 {
            // SAFETY: the machine has AVX (see the type).
            let bits = unsafe {
                let below = _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, lower.0);
                let above = _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, upper.0);
                _mm256_movemask_pd(_mm256_or_pd(below, above))
            };
            u64::from(bits.cast_unsigned())
        }

        #[inline(always)]
        fn sums([a, b, c, d]: [Self; 4]) -> [f64; 4] {
            let mut sums = [0.0; 4];
            // SAFETY: the machine has AVX (see the type).
            let total = unsafe {
                let (ab, cd) = (_mm256_hadd_pd(a.0, b.0), _mm256_hadd_pd(c.0, d.0));
                let low = _mm256_permute2f128_pd::<0x20>(ab, cd);
                _mm256_add_pd(low, _mm256_permute2f128_pd::<0x31>(ab, cd))
            };
            Self(total).store(&mut sums);
            sums
        }
    }
}
