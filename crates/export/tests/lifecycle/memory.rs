//! Memory of the heap that the library holds: all live blocks except those of the test itself.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicIsize, Ordering};

pub struct Counting;

/// Bytes that the test holds, as the heap counts them.
static HELD: AtomicIsize = AtomicIsize::new(0);

/// Overhead of the heap for each block besides its usable bytes.
const HEADER: usize = 8;

fn count(pointer: *mut u8, sign: isize) {
    // SAFETY: the pointer is NULL or a block of the C heap, on which System stands.
    let usable = unsafe { libc::malloc_usable_size(pointer.cast()) };
    let block = if pointer.is_null() { 0 } else { (usable + HEADER).cast_signed() };
    HELD.fetch_add(sign * block, Ordering::Relaxed);
}

// SAFETY: every call is passed on unchanged to the system's allocator; the counter is an atomic.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's contract is the one of this function.
        let pointer = unsafe { System.alloc(layout) };
        count(pointer, 1);
        pointer
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count(pointer, -1);
        // SAFETY: the caller's contract is the one of this function.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(pointer, -1);
        // SAFETY: the caller's contract is the one of this function.
        let moved = unsafe { System.realloc(pointer, layout, size) };
        count(if moved.is_null() { pointer } else { moved }, 1);
        moved
    }
}

/// Bytes of the heap that are live and not the test's own.
pub fn foreign_bytes() -> isize {
    // SAFETY: it only reads the heap's own books.
    let info = unsafe { libc::mallinfo2() };
    (info.uordblks + info.hblkhd).cast_signed() - HELD.load(Ordering::Relaxed)
}
