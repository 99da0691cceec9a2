//! Derivatives, of outputs by inputs and by time, and of inputs over the next step.

use super::*;

impl World<'_> {
    /// Calls for the derivatives of outputs by inputs.
    pub(super) fn directional_derivative(
        &mut self,
        slot: usize,
        kind: Kind,
        dice: &mut Dice,
    ) -> Check {
        let scene = self.scene(slot);
        let (of, by) = match kind {
            Kind::Input => (&scene.inputs, &scene.inputs),
            Kind::Output => (&scene.outputs, &scene.outputs),
            Kind::Fixed => (&scene.outputs, &scene.fixed),
            _ => (&scene.outputs, &scene.inputs),
        };
        let (of, by) = (Self::some(of, 4, dice), Self::some(by, 3, dice));
        let real = scene.reals[0];
        // Half of what is wrong is so with the one, half with the other.
        let is_first = dice.one_in(2);
        let [kind_of, kind_by] = if is_first { [kind, Kind::Good] } else { [Kind::Good, kind] };
        let unknowns = self.references(slot, kind_of, of, real, dice);
        let knowns = self.references(slot, kind_by, by, real, dice);
        let mut changes: Vec<f64> = knowns.iter().map(|_| dice.between(-1.0, 1.0)).collect();
        if kind == Kind::NotFinite {
            changes[0] = dice.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]);
        }
        let mut of = Arrays::new(kind_of, unknowns, &[], CANARY, dice);
        let mut by = Arrays::new(kind_by, knowns, &changes, 0.0, dice);
        if kind == Kind::Empty {
            of.count = 0;
        }
        let function = self.fmi.fmi2GetDirectionalDerivative;
        let rows = &["fmi2GetDirectionalDerivative"];
        // SAFETY: the handle is NULL or alive; the arrays are as long as said, or not to be read.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            let (knowns, count, changes) = (by.references(), by.count, by.values(twin));
            function(handle, of.references(), of.count, knowns, count, changes, of.values(twin))
        })?;
        of.check_read(status != ERROR, CANARY)
    }

    /// Calls for the time derivatives of outputs.
    pub(super) fn output_derivatives(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let scene = self.scene(slot);
        let of = if kind == Kind::Input { &scene.inputs } else { &scene.outputs };
        let good = Self::some(of, 4, dice);
        let references = self.references(slot, kind, good, scene.reals[0], dice);
        let orders = Self::orders(kind, references.len(), dice);
        let mut arrays = Arrays::new(kind, references, &[], CANARY, dice);
        let function = self.fmi.fmi2GetRealOutputDerivatives;
        let rows = &["fmi2GetRealOutputDerivatives"];
        // SAFETY: as above.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            let (references, count) = (arrays.references(), arrays.count);
            function(handle, references, count, orders.as_ptr(), arrays.values(twin))
        })?;
        arrays.check_read(status != ERROR, CANARY)
    }

    /// Calls that set the rates of inputs over the next step.
    pub(super) fn input_derivatives(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let scene = self.scene(slot);
        let of = match kind {
            Kind::Tunable if !scene.tunable.is_empty() => &scene.tunable,
            Kind::Tunable | Kind::Fixed => &scene.fixed,
            Kind::Output => &scene.outputs,
            _ => &scene.inputs,
        };
        let good = Self::some(of, 3, dice);
        let references = self.references(slot, kind, good, scene.reals[0], dice);
        let orders = Self::orders(kind, references.len(), dice);
        // So slow that no step makes of a good value one that is not.
        let mut rates: Vec<f64> = references.iter().map(|_| dice.between(-1e-3, 1e-3)).collect();
        if kind == Kind::NotFinite {
            rates[0] = dice.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]);
        }
        let mut arrays = Arrays::new(kind, references, &rates, 0.0, dice);
        let function = self.fmi.fmi2SetRealInputDerivatives;
        let rows = &["fmi2SetRealInputDerivatives"];
        // SAFETY: as above.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            let (references, count) = (arrays.references(), arrays.count);
            function(handle, references, count, orders.as_ptr(), arrays.values(twin))
        })?;
        if status != ERROR && kind != Kind::Empty {
            let life = self.life(slot);
            for (&reference, &rate) in arrays.references.iter().zip(&rates) {
                life.rates.insert(reference, rate);
            }
        }
        Ok(())
    }

    /// Asks the second twin alone what it must not keep: its state out and in again, and derivatives. Whatever that
    /// leaves behind shows as a difference from the first.
    pub(super) fn disturb(&mut self, slot: usize) -> Check {
        let (scene, fmi) = (self.scene(slot), self.fmi);
        let handle = self.twins(slot).handles[1];
        let has_moved = matches!(self.life(slot).phase, Phase::StepComplete | Phase::Terminated);
        let (of, by) = (&scene.outputs, &scene.inputs);
        let (changes, orders) = (vec![1.0; by.len()], vec![1; of.len()]);
        let (mut found, mut size) = (vec![0.0; of.len()], 0);
        let (mut state, mut read): (Handle, Handle) = (ptr::null_mut(), ptr::null_mut());
        // SAFETY: the handle is alive; arrays are as long as said; states are freed and not used again.
        let statuses = unsafe {
            let mut statuses = vec![
                (fmi.fmi2GetFMUstate)(handle, &raw mut state),
                (fmi.fmi2SerializedFMUstateSize)(handle, state, &raw mut size),
            ];
            let mut bytes = vec![0; size];
            statuses.extend([
                (fmi.fmi2SerializeFMUstate)(handle, state, bytes.as_mut_ptr(), size),
                (fmi.fmi2DeSerializeFMUstate)(handle, bytes.as_ptr(), size, &raw mut read),
                (fmi.fmi2SetFMUstate)(handle, read),
                (fmi.fmi2FreeFMUstate)(handle, &raw mut state),
                (fmi.fmi2FreeFMUstate)(handle, &raw mut read),
            ]);
            if has_moved {
                let (unknowns, knowns) = (of.as_ptr(), by.as_ptr());
                let room = found.as_mut_ptr();
                statuses.extend([
                    (fmi.fmi2GetDirectionalDerivative)(
                        handle,
                        unknowns,
                        of.len(),
                        knowns,
                        by.len(),
                        changes.as_ptr(),
                        room,
                    ),
                    (fmi.fmi2GetRealOutputDerivatives)(
                        handle,
                        unknowns,
                        of.len(),
                        orders.as_ptr(),
                        room,
                    ),
                ]);
            }
            statuses
        };
        if statuses.iter().all(|status| *status == OK) {
            return Ok(());
        }
        Err(format!("state out and in again, derivatives: {statuses:?}"))
    }

    /// There are those of order 1.
    fn orders(kind: Kind, count: usize, dice: &mut Dice) -> Vec<c_int> {
        let mut orders = vec![1; count];
        if kind == Kind::WrongOrder {
            orders[dice.below(count)] = dice.pick(&[0, 2, -1, c_int::MAX, c_int::MIN]);
        }
        orders
    }
}
