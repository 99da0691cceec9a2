//! Arrays that end, or begin, where the system lets nobody read or write.

use super::instance::Instance;
use super::status::Refused;
use super::values::{Get, Set, function};
use crate::description::Kind;
use std::ptr;

/// The side of an array on which memory that cannot be accessed follows at once.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Side {
    Begin,
    End,
}

/// An array beside memory that cannot be accessed.
struct Guarded<T> {
    /// The pages: a guard, the array's own, a guard.
    pages: *mut libc::c_void,
    size: usize,
    array: *mut T,
}

impl<T: Copy> Guarded<T> {
    const PAGE: usize = 4096;

    /// Copies `content` to a place beside a guard; `None` if the system has no memory for it.
    fn new(content: &[T], side: Side, is_read_only: bool) -> Option<Self> {
        let bytes = size_of_val(content);
        let own = bytes.next_multiple_of(Self::PAGE).max(Self::PAGE);
        let size = own + 2 * Self::PAGE;
        // SAFETY: this asks for new memory, which nothing else uses.
        let pages = unsafe {
            libc::mmap(
                ptr::null_mut(),
                size,
                libc::PROT_NONE,
                libc::MAP_PRIVATE | libc::MAP_ANONYMOUS,
                -1,
                0,
            )
        };
        if pages == libc::MAP_FAILED {
            return None;
        }
        let offset = Self::PAGE + if matches!(side, Side::End) { own - bytes } else { 0 };
        let made = Self { pages, size, array: pages.wrapping_byte_add(offset).cast() };
        made.protect(own, libc::PROT_READ | libc::PROT_WRITE)?;
        // SAFETY: the pages can be written now and hold so many bytes from there; the size of a type is a multiple of its
        // alignment, to which the page's end is aligned.
        unsafe { ptr::copy_nonoverlapping(content.as_ptr(), made.array, content.len()) };
        if is_read_only {
            made.protect(own, libc::PROT_READ)?;
        }
        Some(made)
    }

    fn protect(&self, own: usize, access: i32) -> Option<()> {
        // SAFETY: the pages belong to this array alone.
        let result =
            unsafe { libc::mprotect(self.pages.wrapping_byte_add(Self::PAGE), own, access) };
        (result == 0).then_some(())
    }
}

impl<T> Drop for Guarded<T> {
    fn drop(&mut self) {
        // SAFETY: the pages are used no more.
        unsafe { libc::munmap(self.pages, self.size) };
    }
}

impl Instance<'_> {
    /// Reads variables of one type into an array beside a guard; the references can only be read, and lie beside one too.
    pub(crate) fn read_guarded(
        &self,
        kind: Kind,
        references: &[u32],
        side: Side,
    ) -> Result<(), Refused> {
        match kind.base() {
            Kind::Real => self.get_guarded(kind, references, 0.0_f64, side),
            Kind::String => self.get_guarded(kind, references, ptr::null::<libc::c_char>(), side),
            _ => self.get_guarded(kind, references, 0_i32, side),
        }
    }

    fn get_guarded<T: Copy>(
        &self,
        kind: Kind,
        references: &[u32],
        empty: T,
        side: Side,
    ) -> Result<(), Refused> {
        let function = self.function::<Get<T>>(&function("Get", kind))?;
        let values = vec![empty; references.len()];
        let (Some(asked), Some(read)) =
            (Guarded::new(references, side, true), Guarded::new(&values, side, false))
        else {
            return Ok(());
        };
        // SAFETY: the component is alive and the arrays are of the length that is stated. A library that leaves them ends
        // this process.
        self.succeeded(unsafe {
            function(self.component(), asked.array, references.len(), read.array)
        })
    }

    /// Sets Real variables from an array that can only be read and lies beside a guard, as the references do.
    pub(crate) fn write_guarded(
        &self,
        references: &[u32],
        values: &[f64],
        side: Side,
    ) -> Result<(), Refused> {
        let function = self.function::<Set<f64>>("fmi2SetReal")?;
        let (Some(asked), Some(written)) =
            (Guarded::new(references, side, true), Guarded::new(values, side, true))
        else {
            return Ok(());
        };
        let count = references.len().min(values.len());
        // SAFETY: as above.
        self.succeeded(unsafe { function(self.component(), asked.array, count, written.array) })
    }
}
