//! After the first inference of a size, an inference allocates nothing on any thread.
//!
//! This is a separate process, because the allocator counts the calls of all threads.
#![allow(unsafe_code, clippy::unwrap_used, missing_docs)]

#[path = "it/support.rs"]
mod support;

use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicUsize, Ordering},
};

use ndarray::{Array4, Array5, s};
use support::{input, weights};
use vision_models::{Options, ResNet, ResNetDepth, SlowOnly, SlowOnlyForm, SlowOnlyStream};

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: every call is passed on to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `GlobalAlloc::alloc`, which is that of `System`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: `pointer` came from `System` with this layout, as the caller guarantees.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Returns how often `work` calls the allocator.
fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    work();
    ALLOCATIONS.load(Ordering::Relaxed) - before
}

/// A single test, so that no other test runs on another thread at the same time.
#[test]
fn inference_does_not_allocate() {
    assert!(allocations(|| drop(std::hint::black_box(vec![1.0_f32; 8]))) > 0);

    let options = Options { threads: 2, ..Options::default() };
    let images: Array4<f32> = input((2, 3, 64, 64));
    let tensors = weights(ResNet::parameters(ResNetDepth::Eighteen, 4));
    let mut network = ResNet::load(ResNetDepth::Eighteen, tensors, [64, 64], options).unwrap();
    network.infer(images.view()).unwrap();
    assert_eq!(allocations(|| assert!(network.infer(images.view()).is_ok())), 0);

    // Changes between planned sizes allocate nothing.
    let others: Array4<f32> = input((2, 3, 40, 72));
    network.plan([40, 72]).unwrap();
    network.infer(others.view()).unwrap();
    assert_eq!(allocations(|| assert!(network.infer(images.view()).is_ok())), 0);
    assert_eq!(allocations(|| assert!(network.infer(others.view()).is_ok())), 0);

    let form = SlowOnlyForm::MmAction2Depth18;
    let clips: Array5<f32> = input((1, 3, 4, 48, 48));
    let load = || {
        let tensors = weights(SlowOnly::parameters(form, 4));
        SlowOnly::load(form, tensors, [4, 48, 48], options).unwrap()
    };
    let mut network = load();
    network.infer(clips.view()).unwrap();
    assert_eq!(allocations(|| assert!(network.infer(clips.view()).is_ok())), 0);

    let mut stream = SlowOnlyStream::new(load(), [4, 48, 48]).unwrap();
    let push = |stream: &mut SlowOnlyStream, frame: usize| {
        assert!(stream.push(clips.slice(s![0, .., frame % 4, .., ..])).is_ok());
    };
    (0..4).for_each(|frame| push(&mut stream, frame));
    assert_eq!(allocations(|| (4..6).for_each(|frame| push(&mut stream, frame))), 0);
}
