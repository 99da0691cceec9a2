//! The C library's generator of random numbers.

/// Seeds the generator. To be called while the process has one thread, before a library is loaded.
pub(crate) fn seed(number: u32) {
    // SAFETY: no other thread uses the generator: the process has one, and no library of others yet.
    unsafe { libc::srand(number) }
}
