//! What the C library knows of its heap.

/// Bytes of the heap that are in use, where the C library can tell.
pub(crate) fn heap() -> Option<usize> {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    {
        type Ask = unsafe extern "C" fn() -> libc::mallinfo2;
        let process = libloading::os::unix::Library::this();
        // Looked up: glibc has it since 2.33 only.
        // SAFETY: the function is of this type.
        let ask = unsafe { process.get::<Ask>(b"mallinfo2") }.ok()?;
        // SAFETY: it only reads the allocator's counts.
        let info = unsafe { ask() };
        Some(info.uordblks + info.hblkhd)
    }
    #[cfg(not(all(target_os = "linux", target_env = "gnu")))]
    None
}
