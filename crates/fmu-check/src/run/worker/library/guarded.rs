//! Arrays that end, or begin, where the system lets nobody read or write.

use super::instance::Instance;
use super::status::Refused;
use super::values::{Get, Set, Value, function};
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
    /// Copies `content` to a place beside a guard; `None` if the system has no memory for it.
    fn new(content: &[T], side: Side, is_read_only: bool) -> Option<Self> {
        // SAFETY: the call takes a name and returns a number.
        let page = usize::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).ok()?;
        let bytes = size_of_val(content);
        let own = bytes.next_multiple_of(page).max(page);
        let size = own + 2 * page;
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
        let offset = page + if matches!(side, Side::End) { own - bytes } else { 0 };
        let made = Self { pages, size, array: pages.wrapping_byte_add(offset).cast() };
        let protect = |access: i32| {
            // SAFETY: the pages belong to this array alone.
            let result = unsafe { libc::mprotect(pages.wrapping_byte_add(page), own, access) };
            (result == 0).then_some(())
        };
        protect(libc::PROT_READ | libc::PROT_WRITE)?;
        // SAFETY: the array lies in pages that can be written now, and has room for the content. It is aligned: it begins at
        // a page, or ends at one, and the size of a type is a multiple of its alignment.
        unsafe { ptr::copy_nonoverlapping(content.as_ptr(), made.array, content.len()) };
        if is_read_only {
            protect(libc::PROT_READ)?;
        }
        Some(made)
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

    /// Sets variables of one type from an array that can only be read and lies beside a guard, as the references do.
    /// Strings are left out.
    pub(crate) fn write_guarded(
        &self,
        kind: Kind,
        values: &[(u32, &Value)],
        side: Side,
    ) -> Result<(), Refused> {
        let all = values.iter().map(|(_, value)| *value);
        let references: Vec<u32> = values.iter().map(|(reference, _)| *reference).collect();
        match kind.base() {
            Kind::Real => {
                let values: Vec<f64> = all.filter_map(Value::real).collect();
                self.set_guarded(kind, &references, &values, side)
            }
            Kind::String => Ok(()),
            _ => {
                let values: Vec<i32> = all.filter_map(Value::integer).collect();
                self.set_guarded(kind, &references, &values, side)
            }
        }
    }

    fn set_guarded<T: Copy>(
        &self,
        kind: Kind,
        references: &[u32],
        values: &[T],
        side: Side,
    ) -> Result<(), Refused> {
        let function = self.function::<Set<T>>(&function("Set", kind))?;
        assert_eq!(references.len(), values.len());
        let (Some(asked), Some(written)) =
            (Guarded::new(references, side, true), Guarded::new(values, side, true))
        else {
            return Ok(());
        };
        // SAFETY: the component is alive and the arrays are of the length that is stated. A library that leaves them ends
        // this process.
        self.succeeded(unsafe {
            function(self.component(), asked.array, references.len(), written.array)
        })
    }
}
