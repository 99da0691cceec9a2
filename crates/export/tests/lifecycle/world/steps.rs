//! Steps.

use super::*;

impl World<'_> {
    pub(super) fn do_step(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let step = self.scene(slot).step as usize;
        let life = self.life(slot);
        let h = life.values[step];
        let (mut time, mut size) = (life.time, h * (1 + dice.below(4)) as f64);
        if kind == Kind::Good && dice.one_in(4) {
            size *= dice.between(0.1, 1.0);
        }
        match kind {
            Kind::Zero => size = dice.pick(&[0.0, -0.0]),
            Kind::Rounded => size = 1.1e-16,
            Kind::Negative => size = -dice.pick(&[h, 1.0, 1e300]),
            Kind::NotFinite => size = dice.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]),
            Kind::WrongTime => time += h * dice.pick(&[-5.0, -2.0, 2.0, 1e6]),
            Kind::NotFiniteTime => {
                time = dice.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]);
            }
            Kind::BeyondStop => {
                size = life.stop.map_or(1e300, |stop| stop - time + 1.0);
            }
            Kind::TooFar => size = dice.pick(&[1e300, f64::MAX]),
            _ => {}
        }
        let fit = match kind {
            Kind::Zero | Kind::Rounded => Fit::Good,
            _ => fit_of(kind),
        };
        let rows: &[_] = match kind {
            Kind::Zero => &["fmi2DoStep", "(length-zero)"],
            _ => &["fmi2DoStep"],
        };
        let prior = c_int::from(dice.one_in(2));
        let function = self.fmi.fmi2DoStep;
        // SAFETY: the handle is NULL or alive.
        let status = self.call(slot, kind, rows, fit, &mut |_, handle| unsafe {
            function(handle, time, size, prior)
        })?;
        if status != ERROR {
            self.life(slot).time = time + size;
            // At time zero nothing is so small that it must be rounding.
            let is_nothing = kind == Kind::Zero || (kind == Kind::Rounded && time != 0.0);
            if !is_nothing {
                return self.end_rates(slot, size);
            }
        }
        Ok(())
    }

    /// Inputs that had rates over a step have come to where they led, and stay there.
    pub(super) fn end_rates(&mut self, slot: usize, size: f64) -> Check {
        for (reference, rate) in std::mem::take(&mut self.life(slot).rates) {
            let mut read = [0.0; 2];
            let function = self.fmi.fmi2GetReal;
            let rows = &["fmi2GetReal"];
            // SAFETY: the handle is alive, and the arrays have one place.
            self.call(slot, Kind::Good, rows, Fit::Good, &mut |twin, handle| unsafe {
                function(handle, &raw const reference, 1, &raw mut read[twin])
            })?;
            let value = &mut self.life(slot).values[reference as usize];
            let expected = *value + rate * size;
            // Steps are counted from the start, so that their times are rounded.
            if (read[0] - expected).abs() > 1e-12 * (1.0 + expected.abs()) || read[0] != read[1] {
                return Err(format!("reference {reference} comes to {read:?}, not {expected}"));
            }
            *value = read[0];
        }
        Ok(())
    }

    pub(super) fn status(
        &mut self,
        slot: usize,
        name: &'static str,
        kind: Kind,
        dice: &mut Dice,
    ) -> Check {
        let query = match kind {
            Kind::DoStepStatus => 0,
            Kind::Pending => 1,
            Kind::LastSuccessfulTime => 2,
            Kind::Terminated => 3,
            Kind::UnknownStatus => dice.pick(&[-1, 4, c_int::MAX, c_int::MIN]),
            _ => dice.pick(&[0, 1, 2, 3]),
        };
        let fit = match (name, query) {
            _ if matches!(kind, Kind::NullPointer | Kind::Misaligned) => Fit::Bad,
            ("fmi2GetRealStatus", 2) | ("fmi2GetBooleanStatus", 3) => Fit::Good,
            _ => Fit::NoAnswer,
        };
        // Room for the largest of the values.
        let mut values = [[-1.5_f64; 2]; 2];
        let fmi = self.fmi;
        // SAFETY: the handle is NULL or alive; there is room for any value, or it is not to be used.
        let status = self.call(slot, kind, &[name], fit, &mut |twin, handle| unsafe {
            let place: *mut c_void = match kind {
                Kind::NullPointer => ptr::null_mut(),
                Kind::Misaligned => values[twin].as_mut_ptr().wrapping_byte_add(1).cast(),
                _ => values[twin].as_mut_ptr().cast(),
            };
            match name {
                "fmi2GetStatus" => (fmi.fmi2GetStatus)(handle, query, place.cast()),
                "fmi2GetRealStatus" => (fmi.fmi2GetRealStatus)(handle, query, place.cast()),
                "fmi2GetIntegerStatus" => (fmi.fmi2GetIntegerStatus)(handle, query, place.cast()),
                "fmi2GetBooleanStatus" => (fmi.fmi2GetBooleanStatus)(handle, query, place.cast()),
                _ => (fmi.fmi2GetStringStatus)(handle, query, place.cast()),
            }
        })?;
        let is_answered = matches!(status, OK | WARNING);
        let life = self.life(slot);
        for [value, beyond] in values {
            let expected = match name {
                _ if !is_answered => -1.5,
                "fmi2GetRealStatus" => life.time,
                // False, in the half of the place that it takes; the other half is that of −1.5.
                _ => f64::from_bits((-1.5_f64).to_bits() >> 32 << 32),
            };
            if value.to_bits() != expected.to_bits() || beyond != -1.5 {
                return Err(format!("{name} answers {value}, not {expected}"));
            }
        }
        Ok(())
    }
}
