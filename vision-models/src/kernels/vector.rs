//! A vector of f32 lanes, with one implementation per instruction set.

/// A SIMD register. The kernels are written once over this trait. They are compiled once for each
/// instruction set, inside a function that has it enabled (see
/// [`InstructionSet::run`](super::isa::InstructionSet::run)).
///
/// # Safety
/// Every method needs the instruction set of the type. `load` and `store` need `LANES` floats at
/// the pointer, of any alignment.
pub(super) unsafe trait Vector: Copy {
    /// Number of floats in a register.
    const LANES: usize;
    /// A register of half as many lanes, or the same register if the kernels have no smaller one.
    /// Its instruction set is part of this one's.
    type Half: Vector;

    /// Loads `LANES` floats from memory.
    unsafe fn load(from: *const f32) -> Self;
    /// Stores `LANES` floats to memory.
    unsafe fn store(self, to: *mut f32);
    /// Returns the same value in every lane.
    unsafe fn splat(value: f32) -> Self;
    /// Returns self · factor + term, rounded once if the instruction set can.
    unsafe fn mul_add(self, factor: Self, term: Self) -> Self;
    /// Returns self + other.
    unsafe fn add(self, other: Self) -> Self;
    /// Returns self − other.
    unsafe fn sub(self, other: Self) -> Self;
    /// Returns the maximum of each lane, or the lane of `other` if one is NaN.
    unsafe fn max(self, other: Self) -> Self;
    /// Returns the minimum of each lane, or the lane of `other` if one is NaN.
    unsafe fn min(self, other: Self) -> Self;

    /// Returns zero for negative lanes, and NaN for lanes that are NaN or infinite. An overflow
    /// thus stays visible, which a plain maximum would turn into zero.
    #[inline(always)]
    unsafe fn relu(self) -> Self {
        // SAFETY: passed on to the caller.
        unsafe {
            let zero = Self::splat(0.0);
            self.max(self.mul_add(zero, zero))
        }
    }

    /// Multiplies negative lanes by `slope`. Lanes that are NaN or infinite become NaN.
    #[inline(always)]
    unsafe fn prelu(self, slope: Self) -> Self {
        // SAFETY: passed on to the caller.
        unsafe {
            let positive = self.relu();
            self.sub(positive).mul_add(slope, positive)
        }
    }
}

/// Fetches a cache line that will be read soon. The address may be invalid.
#[inline(always)]
pub(super) fn prefetch(address: *const f32) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: a prefetch is a hint, harmless for any address, and every x86-64 has it.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T1, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T1>(address.cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = address;
}

/// Plain Rust, for processors without any of the other instruction sets.
#[derive(Clone, Copy)]
pub(super) struct Portable([f32; 8]);

// SAFETY: needs no instruction set. `load` and `store` use `LANES` floats.
unsafe impl Vector for Portable {
    const LANES: usize = 8;
    type Half = Self;

    #[inline(always)]
    unsafe fn load(from: *const f32) -> Self {
        // SAFETY: the caller gives eight floats, and an array of f32 has their alignment.
        unsafe { Self(from.cast::<[f32; 8]>().read_unaligned()) }
    }

    #[inline(always)]
    unsafe fn store(self, to: *mut f32) {
        // SAFETY: the caller gives room for eight floats.
        unsafe { to.cast::<[f32; 8]>().write_unaligned(self.0) }
    }

    #[inline(always)]
    unsafe fn splat(value: f32) -> Self {
        Self([value; 8])
    }

    #[inline(always)]
    unsafe fn mul_add(self, factor: Self, term: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] * factor.0[lane] + term.0[lane]))
    }

    #[inline(always)]
    unsafe fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] + other.0[lane]))
    }

    #[inline(always)]
    unsafe fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| self.0[lane] - other.0[lane]))
    }

    #[inline(always)]
    unsafe fn max(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| {
            if self.0[lane] > other.0[lane] { self.0[lane] } else { other.0[lane] }
        }))
    }

    #[inline(always)]
    unsafe fn min(self, other: Self) -> Self {
        Self(std::array::from_fn(|lane| {
            if self.0[lane] < other.0[lane] { self.0[lane] } else { other.0[lane] }
        }))
    }
}

/// Implements [`Vector`] with the intrinsics of one instruction set.
macro_rules! vector {
    ($register:ty, $half:ty, $lanes:literal, $load:ident, $store:ident, $splat:ident, $mul_add:expr,
     $add:ident, $sub:ident, $max:ident, $min:ident) => {
        // SAFETY: the intrinsics are those of the type's instruction set, which the caller has
        // enabled. The unaligned loads and stores use exactly its lanes.
        unsafe impl Vector for $register {
            const LANES: usize = $lanes;
            type Half = $half;

            #[inline(always)]
            unsafe fn load(from: *const f32) -> Self {
                // SAFETY: passed on to the caller.
                unsafe { $load(from) }
            }

            #[inline(always)]
            unsafe fn store(self, to: *mut f32) {
                // SAFETY: passed on to the caller.
                unsafe { $store(to, self) }
            }

            #[inline(always)]
            unsafe fn splat(value: f32) -> Self {
                // SAFETY: passed on to the caller.
                unsafe { $splat(value) }
            }

            #[inline(always)]
            unsafe fn mul_add(self, factor: Self, term: Self) -> Self {
                // SAFETY: passed on to the caller.
                unsafe { $mul_add(self, factor, term) }
            }

            #[inline(always)]
            unsafe fn add(self, other: Self) -> Self {
                // SAFETY: passed on to the caller.
                unsafe { $add(self, other) }
            }

            #[inline(always)]
            unsafe fn sub(self, other: Self) -> Self {
                // SAFETY: passed on to the caller.
                unsafe { $sub(self, other) }
            }

            #[inline(always)]
            unsafe fn max(self, other: Self) -> Self {
                // SAFETY: passed on to the caller.
                unsafe { $max(self, other) }
            }

            #[inline(always)]
            unsafe fn min(self, other: Self) -> Self {
                // SAFETY: passed on to the caller.
                unsafe { $min(self, other) }
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::Vector;
    use std::arch::x86_64::{
        __m256, __m512, _mm256_add_ps, _mm256_fmadd_ps, _mm256_loadu_ps, _mm256_max_ps,
        _mm256_min_ps, _mm256_set1_ps, _mm256_storeu_ps, _mm256_sub_ps, _mm512_add_ps,
        _mm512_fmadd_ps, _mm512_loadu_ps, _mm512_max_ps, _mm512_min_ps, _mm512_set1_ps,
        _mm512_storeu_ps, _mm512_sub_ps,
    };

    vector!(
        __m256,
        __m256,
        8,
        _mm256_loadu_ps,
        _mm256_storeu_ps,
        _mm256_set1_ps,
        _mm256_fmadd_ps,
        _mm256_add_ps,
        _mm256_sub_ps,
        _mm256_max_ps,
        _mm256_min_ps
    );
    vector!(
        __m512,
        __m256,
        16,
        _mm512_loadu_ps,
        _mm512_storeu_ps,
        _mm512_set1_ps,
        _mm512_fmadd_ps,
        _mm512_add_ps,
        _mm512_sub_ps,
        _mm512_max_ps,
        _mm512_min_ps
    );
}

#[cfg(target_arch = "aarch64")]
mod arm {
    use super::Vector;
    use std::arch::aarch64::{
        float32x4_t, vaddq_f32, vdupq_n_f32, vfmaq_f32, vld1q_f32, vmaxq_f32, vminq_f32, vst1q_f32,
        vsubq_f32,
    };

    vector!(
        float32x4_t,
        float32x4_t,
        4,
        vld1q_f32,
        vst1q_f32,
        vdupq_n_f32,
        |value, factor, term| vfmaq_f32(term, value, factor),
        vaddq_f32,
        vsubq_f32,
        vmaxq_f32,
        vminq_f32
    );
}
