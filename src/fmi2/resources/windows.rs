//! Location of the FMU's resources on Windows.

use super::windows_path;
use std::ffi::OsString;
use std::os::windows::ffi::OsStringExt;
use std::path::PathBuf;
use windows_sys::Win32::Foundation::{HMODULE, MAX_PATH};
use windows_sys::Win32::System::LibraryLoader::{
    GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS, GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT,
    GetModuleFileNameW, GetModuleHandleExW,
};

/// The path that an importer's URI names.
pub(super) fn located(uri: &[u8]) -> Option<PathBuf> {
    windows_path::located(uri).map(PathBuf::from)
}

/// The file that this code was loaded from.
#[allow(unsafe_code)]
pub(super) fn library() -> Option<PathBuf> {
    let mut module: HMODULE = std::ptr::null_mut();
    let flags =
        GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS | GET_MODULE_HANDLE_EX_FLAG_UNCHANGED_REFCOUNT;
    // SAFETY: the flags say that the name is an address in the module, which is this library; it stays loaded
    // while its code runs, and `module` has room for the answer.
    let found = unsafe { GetModuleHandleExW(flags, library as *const u16, &mut module) };
    if found == 0 {
        return None;
    }
    let mut name = vec![0; MAX_PATH as usize];
    loop {
        let room = u32::try_from(name.len()).ok()?;
        // SAFETY: `name` has `room` elements, and `module` is loaded.
        let length = unsafe { GetModuleFileNameW(module, name.as_mut_ptr(), room) } as usize;
        match length {
            0 => return None,
            // The name was cut off: paths may be longer than MAX_PATH.
            cut if cut >= name.len() => name.resize(2 * name.len(), 0),
            _ => return Some(PathBuf::from(OsString::from_wide(&name[..length]))),
        }
    }
}
