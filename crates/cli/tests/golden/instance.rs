//! An FMU's instance, by the functions of its library, which this test links: only they have saved states as bytes.

use crate::c;
use amontons::scene::{Scene, Source};
use amontons::simulation::catalogue::{Kind, fmu_variables};
use amontons::simulation::fingerprint;
use std::ffi::{CString, c_uint};
use std::fs;
use std::ptr::null_mut;

pub struct Instance {
    it: c::Handle,
    reals: Vec<c_uint>,
    _folder: tempfile::TempDir,
}

impl Instance {
    /// At its start.
    pub fn new(scene: &Scene, source: &Source) -> Self {
        let folder = crate::program::folder();
        let files = [("scene.toml", &source.text)].into_iter();
        for (name, text) in files.chain(source.tables.iter().map(|(name, text)| (&**name, text))) {
            fs::write(folder.path().join(name), text).unwrap();
        }
        let location = CString::new(format!("file://{}", folder.path().display())).unwrap();
        let guid = CString::new(fingerprint(source)).unwrap();
        let reals = (0..).zip(fmu_variables(scene));
        let reals = reals.filter(|(_, one)| matches!(one.template.kind, Kind::Real { .. }));
        // SAFETY: FMI's calls in FMI's order; every string is terminated.
        let it = unsafe {
            let (guid, location) = (guid.as_ptr(), location.as_ptr());
            let it = c::fmi2Instantiate(c"one".as_ptr(), 1, guid, location, null_mut(), 0, 0);
            assert!(!it.is_null(), "{} has no instance", scene.name);
            assert_eq!(c::fmi2SetupExperiment(it, 0, 0.0, 0.0, 0, 0.0), 0);
            assert_eq!(c::fmi2EnterInitializationMode(it), 0);
            assert_eq!(c::fmi2ExitInitializationMode(it), 0);
            it
        };
        Self { it, reals: reals.map(|(reference, _)| reference).collect(), _folder: folder }
    }

    /// Goes on from one time to another, s.
    pub fn step(&mut self, from: f64, to: f64) {
        // SAFETY: it is one that has been initialized.
        let stepped = unsafe { c::fmi2DoStep(self.it, from, to - from, 0) };
        assert_eq!(stepped, 0, "from {from} to {to} s");
    }

    /// The bits of all doubles that can be read.
    pub fn read(&mut self) -> Vec<u64> {
        let Self { it, reals, .. } = self;
        let mut values = vec![0.0; reals.len()];
        // SAFETY: both arrays are as long as said.
        let read = unsafe { c::fmi2GetReal(*it, reals.as_ptr(), reals.len(), values.as_mut_ptr()) };
        assert_eq!(read, 0);
        values.into_iter().map(f64::to_bits).collect()
    }

    pub fn save(&mut self) -> Vec<u8> {
        let (it, mut state, mut size) = (self.it, null_mut(), 0);
        // SAFETY: the state is one of this instance until it is freed; the array is as long as said.
        unsafe {
            assert_eq!(c::fmi2GetFMUstate(it, &raw mut state), 0);
            assert_eq!(c::fmi2SerializedFMUstateSize(it, state, &raw mut size), 0);
            let mut bytes = vec![0; size];
            assert_eq!(c::fmi2SerializeFMUstate(it, state, bytes.as_mut_ptr(), size), 0);
            assert_eq!(c::fmi2FreeFMUstate(it, &raw mut state), 0);
            bytes
        }
    }

    pub fn restore(&mut self, bytes: &[u8]) {
        let (it, mut state) = (self.it, null_mut());
        // SAFETY: as above.
        unsafe {
            let made = c::fmi2DeSerializeFMUstate(it, bytes.as_ptr(), bytes.len(), &raw mut state);
            assert_eq!(made, 0);
            assert_eq!(c::fmi2SetFMUstate(it, state), 0);
            assert_eq!(c::fmi2FreeFMUstate(it, &raw mut state), 0);
        }
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: it is not used afterwards.
        unsafe { c::fmi2FreeInstance(self.it) }
    }
}
