//! The platforms of FMI 2.0: their folders, the format of their libraries, and the libraries of every such system.

use object::{Architecture, BinaryFormat};

pub(super) struct Platform {
    pub(super) folder: &'static str,
    pub(super) extension: &'static str,
    pub(super) format: BinaryFormat,
    pub(super) processors: &'static [Architecture],
}

pub(super) static PLATFORMS: &[Platform] = &[
    Platform {
        folder: "linux64",
        extension: "so",
        format: BinaryFormat::Elf,
        processors: &[Architecture::X86_64],
    },
    Platform {
        folder: "linux32",
        extension: "so",
        format: BinaryFormat::Elf,
        processors: &[Architecture::I386],
    },
    Platform {
        folder: "win64",
        extension: "dll",
        format: BinaryFormat::Pe,
        processors: &[Architecture::X86_64],
    },
    Platform {
        folder: "win32",
        extension: "dll",
        format: BinaryFormat::Pe,
        processors: &[Architecture::I386],
    },
    // FMI 2.0 does not name the processor of darwin64; current ones are of two kinds.
    Platform {
        folder: "darwin64",
        extension: "dylib",
        format: BinaryFormat::MachO,
        processors: &[Architecture::X86_64, Architecture::Aarch64],
    },
    Platform {
        folder: "darwin32",
        extension: "dylib",
        format: BinaryFormat::MachO,
        processors: &[Architecture::I386],
    },
];

/// Libraries that every Linux with glibc and GCC's runtime has; their symbols carry versions.
const LINUX: [&str; 13] = [
    "libc.so.6",
    "libm.so.6",
    "libdl.so.2",
    "libpthread.so.0",
    "librt.so.1",
    "libutil.so.1",
    "libresolv.so.2",
    "libanl.so.1",
    "libmvec.so.1",
    "libgcc_s.so.1",
    "libstdc++.so.6",
    "ld-linux-x86-64.so.2",
    "ld-linux.so.2",
];

/// Libraries that every Windows 10 has.
const WINDOWS: &[&str] = &[
    "advapi32.dll",
    "bcrypt.dll",
    "bcryptprimitives.dll",
    "cfgmgr32.dll",
    "combase.dll",
    "comctl32.dll",
    "comdlg32.dll",
    "credui.dll",
    "crypt32.dll",
    "d3d11.dll",
    "dbghelp.dll",
    "dnsapi.dll",
    "dwmapi.dll",
    "dxgi.dll",
    "gdi32.dll",
    "gdiplus.dll",
    "hid.dll",
    "imm32.dll",
    "iphlpapi.dll",
    "kernel32.dll",
    "kernelbase.dll",
    "mpr.dll",
    "mscoree.dll",
    "msi.dll",
    "msimg32.dll",
    "msvcrt.dll",
    "mswsock.dll",
    "ncrypt.dll",
    "netapi32.dll",
    "normaliz.dll",
    "ntdll.dll",
    "odbc32.dll",
    "ole32.dll",
    "oleacc.dll",
    "oleaut32.dll",
    "opengl32.dll",
    "pdh.dll",
    "powrprof.dll",
    "propsys.dll",
    "psapi.dll",
    "rpcrt4.dll",
    "secur32.dll",
    "setupapi.dll",
    "shcore.dll",
    "shell32.dll",
    "shlwapi.dll",
    "ucrtbase.dll",
    "urlmon.dll",
    "user32.dll",
    "userenv.dll",
    "usp10.dll",
    "uxtheme.dll",
    "version.dll",
    "winhttp.dll",
    "wininet.dll",
    "winmm.dll",
    "winspool.drv",
    "wintrust.dll",
    "wldap32.dll",
    "ws2_32.dll",
    "wsock32.dll",
    "wtsapi32.dll",
];

impl Platform {
    pub(super) fn of(folder: &str) -> Option<&'static Self> {
        PLATFORMS.iter().find(|platform| platform.folder == folder)
    }

    /// `true` if every system of this platform has this library.
    pub(super) fn has(&self, library: &str) -> bool {
        match self.format {
            BinaryFormat::Elf => LINUX.contains(&library),
            BinaryFormat::Pe => {
                let library = library.to_ascii_lowercase();
                WINDOWS.contains(&library.as_str())
                    || library.starts_with("api-ms-win-")
                    || library.starts_with("ext-ms-win-")
            }
            _ => library.starts_with("/usr/lib/") || library.starts_with("/System/Library/"),
        }
    }
}

/// The folder of the system that this program runs on, where FMI 2.0 has one.
pub(crate) const HOST: Option<&str> = if cfg!(all(target_os = "linux", target_arch = "x86_64")) {
    Some("linux64")
} else if cfg!(all(target_os = "linux", target_arch = "x86")) {
    Some("linux32")
} else if cfg!(all(windows, target_arch = "x86_64")) {
    Some("win64")
} else if cfg!(all(windows, target_arch = "x86")) {
    Some("win32")
} else if cfg!(target_os = "macos") {
    Some("darwin64")
} else {
    None
};

#[cfg(test)]
mod tests {
    use super::*;

    /// A change of names had once reached into the path of macOS's frameworks.
    #[test]
    fn the_libraries_of_each_system_are_known_and_others_are_not() {
        for (folder, own, other) in [
            ("linux64", "libm.so.6", "libgfortran.so.5"),
            ("win64", "KERNEL32.dll", "libgcc_s_seh-1.dll"),
            ("win64", "api-ms-win-crt-math-l1-1-0.dll", "api.dll"),
            ("darwin64", "/usr/lib/libSystem.B.dylib", "/usr/local/lib/libgcc_s.1.dylib"),
            (
                "darwin64",
                "/System/Library/Frameworks/Accelerate.framework/Versions/A/Accelerate",
                "/Library/Frameworks/R.framework/R",
            ),
        ] {
            let platform = Platform::of(folder).unwrap();
            assert!(platform.has(own) && !platform.has(other), "{folder}: {own}, {other}");
        }
    }
}
