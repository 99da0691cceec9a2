//! Settings of the process that belong to the host: how floating point is computed, and who handles signals.

/// Settings of the host that a library must leave as they are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct HostSettings {
    /// Rounding, flushing of denormal numbers, and traps of floating point; `None` if the processor is not read.
    pub(crate) floating_point: Option<(u32, u16)>,
    /// Handlers of the signals, from signal 1.
    pub(crate) signals: Vec<usize>,
    /// Settings by name.
    pub(crate) named: Vec<(&'static str, String)>,
}

impl HostSettings {
    pub(crate) fn read() -> Self {
        Self { floating_point: floating_point(), signals: signals(), named: named() }
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

#[cfg(unix)]
fn named() -> Vec<(&'static str, String)> {
    let folder = std::env::current_dir().map_or(String::new(), |path| path.display().to_string());
    // SAFETY: NULL asks for the locale, a string that stays until the locale changes.
    let locale = unsafe {
        let name = libc::setlocale(libc::LC_ALL, std::ptr::null());
        if name.is_null() {
            String::new()
        } else {
            std::ffi::CStr::from_ptr(name).to_string_lossy().into_owned()
        }
    };
    let mut mask = std::mem::MaybeUninit::<libc::sigset_t>::zeroed();
    // SAFETY: without a new mask the call only writes the present one; all bytes zero are a mask as well.
    let mask = unsafe {
        libc::pthread_sigmask(libc::SIG_BLOCK, std::ptr::null(), mask.as_mut_ptr());
        mask.assume_init()
    };
    // SAFETY: the mask is initialized and the numbers are those of signals.
    let blocked =
        (1..=31).filter(|signal| unsafe { libc::sigismember(&raw const mask, *signal) } == 1);
    let blocked: Vec<String> = blocked.map(|signal| signal.to_string()).collect();
    vec![
        ("the working folder", folder),
        ("the locale", locale),
        ("the mask of blocked signals", format!("[{}]", blocked.join(" "))),
    ]
}

#[cfg(not(unix))]
fn named() -> Vec<(&'static str, String)> {
    Vec::new()
}
