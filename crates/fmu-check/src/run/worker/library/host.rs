//! What belongs to the host in a process: how floating point is computed, who handles signals, and random numbers.

/// Settings of the host that a library must leave as they are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct HostSettings {
    /// Rounding, flushing of denormal numbers, and traps of floating point; `None` if the processor is not read.
    pub(crate) floating_point: Option<(u32, u16)>,
    /// Handlers of the signals, from signal 1.
    pub(crate) signals: Vec<usize>,
}

impl HostSettings {
    pub(crate) fn read() -> Self {
        Self { floating_point: floating_point(), signals: signals() }
    }
}

#[cfg(target_arch = "x86_64")]
fn floating_point() -> Option<(u32, u16)> {
    /// The flags of exceptions that have occurred; these change with every computation.
    const OCCURRED: u32 = 0x3f;
    let (mut vector, mut scalar) = (0_u32, 0_u16);
    // SAFETY: both instructions store a control register at the address and change nothing else.
    unsafe {
        std::arch::asm!("stmxcsr [{}]", in(reg) &raw mut vector, options(nostack));
        std::arch::asm!("fnstcw [{}]", in(reg) &raw mut scalar, options(nostack));
    }
    Some((vector & !OCCURRED, scalar))
}

#[cfg(not(target_arch = "x86_64"))]
fn floating_point() -> Option<(u32, u16)> {
    None
}

#[cfg(unix)]
fn signals() -> Vec<usize> {
    /// The signals that every Unix has.
    const LAST: i32 = 31;
    let handler = |signal| {
        let mut action = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
        // SAFETY: without a new action the call only writes the present one; all bytes zero are an action as well.
        unsafe {
            libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr());
            action.assume_init().sa_sigaction
        }
    };
    (1..=LAST).map(handler).collect()
}

#[cfg(not(unix))]
fn signals() -> Vec<usize> {
    Vec::new()
}

/// Seeds the C library's generator of random numbers.
pub(crate) fn seed(number: u32) {
    // SAFETY: no other thread of the process uses the generator.
    unsafe { libc::srand(number) }
}
