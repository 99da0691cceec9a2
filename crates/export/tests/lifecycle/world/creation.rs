//! Creation and inquiry.

use super::*;

impl World<'_> {
    pub(super) fn inquire(&mut self, function: &'static str) -> Check {
        // SAFETY: both give a string that lives as long as the library.
        let (answer, expected) = unsafe {
            match function {
                "fmi2GetVersion" => (CStr::from_ptr((self.fmi.fmi2GetVersion)()), c"2.0"),
                _ => (CStr::from_ptr((self.fmi.fmi2GetTypesPlatform)()), c"default"),
            }
        };
        self.tally.count(function, OK);
        if answer == expected { Ok(()) } else { Err(format!("{function} gives {answer:?}")) }
    }

    pub(super) fn instantiate(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let scene = self.scene(slot);
        let other = &self.scenes[scene.other];
        let name = match kind {
            Kind::NullName => ptr::null(),
            Kind::EmptyName => c"".as_ptr(),
            _ => c"one, \xc3\xbc %s".as_ptr(),
        };
        let guid = match kind {
            Kind::NullGuid => ptr::null(),
            Kind::WrongGuid => {
                dice.pick(&[c"", c"{}", c"{00000000-0000-5000-8000-000000000000}"]).as_ptr()
            }
            Kind::NotText => c"\xff\xfe".as_ptr(),
            _ => scene.guid.as_ptr(),
        };
        let location = match kind {
            // Then it would lie beside the library, where nothing is.
            Kind::NullLocation => ptr::null(),
            Kind::WrongLocation => dice
                .pick(&[
                    c"http://host/x",
                    c"file:///nowhere",
                    c"x",
                    c"file://",
                    c"file:///%2",
                    c"/dev/null",
                ])
                .as_ptr(),
            Kind::OtherScene => other.location.as_ptr(),
            _ => scene.location.as_ptr(),
        };
        let of_type = if kind == Kind::WrongType { dice.pick(&[0, 2, -1, c_int::MAX]) } else { 1 };
        let has_logger = !matches!(kind, Kind::NullCallbacks | Kind::NullLogger);
        let is_good = matches!(kind, Kind::Good | Kind::NullCallbacks | Kind::NullLogger);
        let logging_on = dice.one_in(2);
        let heard: [Box<Heard>; 2] = Default::default();
        let mut handles = [ptr::null_mut(); 2];
        for (handle, ear) in handles.iter_mut().zip(&heard) {
            let callbacks = Callbacks {
                logger: has_logger.then_some(log),
                memory: [None; 2],
                step_finished: None,
                environment: ptr::from_ref(&**ear).cast_mut().cast(),
            };
            let callbacks =
                if kind == Kind::NullCallbacks { ptr::null() } else { ptr::from_ref(&callbacks) };
            // SAFETY: strings are terminated or NULL; the logger's environment is kept as long as the instance.
            *handle = unsafe {
                let instantiate = self.fmi.fmi2Instantiate;
                instantiate(name, of_type, guid, location, callbacks, 0, c_int::from(logging_on))
            };
            self.tally.count("fmi2Instantiate", if handle.is_null() { ERROR } else { OK });
            if handle.is_null() == is_good {
                return Err(format!("an instance is made: {is_good} was expected"));
            }
            if ear.errors.get() != usize::from(!is_good) {
                return Err("a refusal has one reason".to_owned());
            }
        }
        if is_good {
            self.free_instance(slot, Kind::Good);
            let life = Life::new(scene.start.clone(), has_logger, logging_on);
            self.slots[slot] = Some(Twins { handles, heard, life });
        }
        Ok(())
    }

    pub(super) fn free_instance(&mut self, slot: usize, kind: Kind) {
        let free = self.fmi.fmi2FreeInstance;
        if kind == Kind::NullInstance {
            // SAFETY: NULL is no instance.
            unsafe { free(ptr::null_mut()) };
            self.tally.count("fmi2FreeInstance", OK);
            return;
        }
        for handle in self.slots[slot].take().into_iter().flat_map(|twins| twins.handles) {
            // SAFETY: it is alive and not used again. (Its logger is not called any more: it may go at the same time.)
            unsafe { free(handle) };
            self.tally.count("fmi2FreeInstance", OK);
        }
    }

    pub(super) fn set_debug_logging(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        const KNOWN: [&CStr; 4] = [c"logStatusError", c"logStatusWarning", c"logEvents", c"logAll"];
        let mut names: Vec<&CStr> = Vec::new();
        if kind != Kind::Empty {
            names = (0..=dice.below(3)).map(|_| dice.pick(&KNOWN)).collect();
        }
        let on = dice.one_in(2);
        let mut rows = vec!["fmi2SetDebugLogging"];
        if kind == Kind::UnknownCategory {
            names.push(dice.pick(&[c"logGossip", c"", c"\xff", c"logall"]));
            rows.push("(unknown-category)");
        }
        let mut pointers: Vec<*const c_char> = names.iter().map(|name| name.as_ptr()).collect();
        if kind == Kind::NullString {
            pointers.push(ptr::null());
        }
        let (mut pointer, mut count) = (pointers.as_ptr(), pointers.len());
        match kind {
            Kind::NullArray => pointer = ptr::null(),
            Kind::Misaligned => pointer = pointer.wrapping_byte_add(1),
            Kind::Huge => count = dice.pick(HUGE),
            _ => {}
        }
        let fit = match kind {
            Kind::UnknownCategory => Fit::Good,
            _ => fit_of(kind),
        };
        let life = self.life(slot);
        let is_taken =
            kind != Kind::NullInstance && fit == Fit::Good && !(life.strict && rows.len() > 1);
        let is_meant = |name| names.is_empty() || names.contains(&name);
        // The warning may be of what is turned on with it.
        if is_taken && (is_meant(c"logStatusWarning") || names.contains(&c"logAll")) {
            life.warns = on;
        }
        let function = self.fmi.fmi2SetDebugLogging;
        // SAFETY: the handle is NULL or alive; the array is as long as said, or one that is not to be read.
        self.call(slot, kind, &rows, fit, &mut |_, handle| unsafe {
            function(handle, c_int::from(on), count, pointer)
        })?;
        Ok(())
    }

    pub(super) fn setup_experiment(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let mut start = dice.pick(&[0.0, 0.0, 1.0, -0.5, 100.0]);
        let mut stop = dice.pick(&[None, Some(start + 1e4), Some(f64::INFINITY)]);
        match kind {
            Kind::NotFinite => match dice.below(3) {
                0 => start = dice.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
                1 => stop = Some(f64::NAN),
                _ => stop = Some(f64::NEG_INFINITY),
            },
            Kind::StopBeforeStart => stop = Some(start - dice.between(1e-3, 10.0)),
            _ => {}
        }
        // The scenes have method and step: a tolerance says nothing, whatever it is.
        let tolerance = dice.pick(&[1e-3, 0.0, -1.0, f64::NAN, f64::INFINITY]);
        let defined = c_int::from(dice.one_in(2));
        let function = self.fmi.fmi2SetupExperiment;
        let rows = &["fmi2SetupExperiment"];
        // SAFETY: the handle is NULL or alive.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |_, handle| unsafe {
            let (has_stop, stop) = (c_int::from(stop.is_some()), stop.unwrap_or(f64::NAN));
            function(handle, defined, tolerance, start, has_stop, stop)
        })?;
        if status != ERROR {
            let life = self.life(slot);
            (life.start, life.time, life.stop, life.is_set_up) = (start, start, stop, true);
        }
        Ok(())
    }
}
