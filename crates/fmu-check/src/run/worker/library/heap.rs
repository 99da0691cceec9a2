//! The size of the heap as the C library reports it.

/// Memory of the heap that is in use, bytes; `None` if the C library does not report it.
pub(crate) fn heap() -> Option<usize> {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        type Ask = unsafe extern "C" fn() -> libc::mallinfo2;
        let process = libloading::os::unix::Library::this();
        // The function is looked up because glibc has it only since version 2.33.
        // SAFETY: the function is of this type.
        let ask = unsafe { process.get::<Ask>(b"mallinfo2") }.ok()?;
        // SAFETY: it only reads the allocator's counts.
        let info = unsafe { ask() };
        Some(info.uordblks + info.hblkhd)
    }
    #[cfg(not(all(target_os = "linux", target_env = "gnu")))]
    None
}
