//! The instruction set of the kernels, chosen at run time.

use super::vector::{Portable, Vector};

/// A task written over any [`Vector`].
pub(super) trait Task {
    /// Runs the task.
    ///
    /// # Safety
    /// The instruction set of `V` must be enabled in the caller, and the task's own requirements
    /// must hold.
    unsafe fn run<V: Vector>(self);
}

/// An instruction set that this processor has. It can only be obtained by detection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InstructionSet(Kind);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// 16 lanes, 32 registers.
    #[cfg(target_arch = "x86_64")]
    Avx512,
    /// 8 lanes, 16 registers, with FMA.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// 4 lanes, 32 registers.
    #[cfg(target_arch = "aarch64")]
    Neon,
    /// Plain Rust.
    Portable,
}

impl InstructionSet {
    /// Returns all instruction sets of this processor, the fastest first.
    pub fn available() -> Vec<Self> {
        let mut available = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") {
                available.push(Self(Kind::Avx512));
            }
            if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
                available.push(Self(Kind::Avx2));
            }
        }
        #[cfg(target_arch = "aarch64")]
        if std::arch::is_aarch64_feature_detected!("neon") {
            available.push(Self(Kind::Neon));
        }
        available.push(Self(Kind::Portable));
        available
    }

    /// Returns the fastest instruction set of this processor.
    pub fn detect() -> Self {
        Self::available().first().copied().unwrap_or(Self(Kind::Portable))
    }

    /// Returns the name of the instruction set.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "AVX-512",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "AVX2",
            #[cfg(target_arch = "aarch64")]
            Kind::Neon => "NEON",
            Kind::Portable => "portable",
        }
    }

    /// Returns how many output channels the matrix kernel computes at once.
    pub(super) fn panel_width(self) -> usize {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => 64,
            _ => 16,
        }
    }

    /// Runs a task with this instruction set.
    ///
    /// # Safety
    /// The task's requirements must hold.
    pub(super) unsafe fn run<T: Task>(self, task: T) {
        match self.0 {
            // SAFETY: the processor has the instruction set, or it would not be available.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => unsafe { run_avx512(task) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => unsafe { run_avx2(task) },
            // SAFETY: as above.
            #[cfg(target_arch = "aarch64")]
            Kind::Neon => unsafe { run_neon(task) },
            // SAFETY: plain Rust needs no instruction set.
            Kind::Portable => unsafe { task.run::<Portable>() },
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx2,fma")]
unsafe fn run_avx512<T: Task>(task: T) {
    // SAFETY: the instruction set is enabled here; the rest is passed on to the caller.
    unsafe { task.run::<std::arch::x86_64::__m512>() }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn run_avx2<T: Task>(task: T) {
    // SAFETY: the instruction set is enabled here; the rest is passed on to the caller.
    unsafe { task.run::<std::arch::x86_64::__m256>() }
}

#[cfg(target_arch = "aarch64")]
#[target_feature(enable = "neon")]
unsafe fn run_neon<T: Task>(task: T) {
    // SAFETY: the instruction set is enabled here; the rest is passed on to the caller.
    unsafe { task.run::<std::arch::aarch64::float32x4_t>() }
}
