//! Variables.

use super::*;

impl World<'_> {
    /// References as asked for: of these, with one among them that is wrong if the kind says so.
    pub(super) fn references(
        &self,
        slot: usize,
        kind: Kind,
        mut good: Vec<u32>,
        avoid: u32,
        dice: &mut Dice,
    ) -> Vec<u32> {
        let scene = self.scene(slot);
        match kind {
            Kind::WrongReference => {
                let count = u32::try_from(scene.start.len()).expect("there are not so many");
                good.push(if dice.one_in(2) { count } else { dice.pick(UNKNOWN) });
            }
            Kind::OtherType => {
                let others = [scene.reals[0], scene.integers[0], scene.boolean];
                let type_of = |reference: u32| {
                    (scene.integers.contains(&reference), reference == scene.boolean)
                };
                let others: Vec<u32> =
                    others.into_iter().filter(|&one| type_of(one) != type_of(avoid)).collect();
                good.push(dice.pick(&others));
            }
            _ => {}
        }
        good
    }

    pub(super) fn some(of: &[u32], most: usize, dice: &mut Dice) -> Vec<u32> {
        (0..=dice.below(most)).map(|_| dice.pick(of)).collect()
    }

    pub(super) fn get_real(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let scene = self.scene(slot);
        let good = Self::some(&scene.reals, 5, dice);
        let references = self.references(slot, kind, good, scene.reals[0], dice);
        let mut arrays = Arrays::new(kind, references, &[], CANARY, dice);
        let (function, rows) = (self.fmi.fmi2GetReal, &["fmi2GetReal"]);
        // SAFETY: the handle is NULL or alive; the arrays are as long as said, or not to be read.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            function(handle, arrays.references(), arrays.count, arrays.values(twin))
        })?;
        let life = self.life(slot);
        for (i, [a, b]) in arrays.pairs().enumerate() {
            if a.to_bits() != b.to_bits() {
                return Err(format!("twins read {a} and {b}"));
            }
            let is_read = status != ERROR && i < arrays.count;
            let Some(&reference) = arrays.references.get(i).filter(|_| is_read) else {
                if (i >= arrays.count || arrays.offsets[1].is_none()) && a != CANARY {
                    return Err("what is none of the array was written to".to_owned());
                }
                continue;
            };
            let known = life.values[reference as usize];
            if !a.is_finite() || (!scene.outputs.contains(&reference) && a != known) {
                return Err(format!("reference {reference} reads {a}; {known} was set"));
            }
        }
        Ok(())
    }

    pub(super) fn get_integer(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let scene = self.scene(slot);
        let good = Self::some(&scene.integers, 3, dice);
        let references = self.references(slot, kind, good, scene.integers[0], dice);
        let mut arrays = Arrays::new(kind, references, &[], -7, dice);
        let (function, rows) = (self.fmi.fmi2GetInteger, &["fmi2GetInteger"]);
        // SAFETY: as of reals.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            function(handle, arrays.references(), arrays.count, arrays.values(twin))
        })?;
        for (i, [a, b]) in arrays.pairs().enumerate() {
            let is_read = status != ERROR && i < arrays.count.min(arrays.references.len());
            // States of contact count from 1, all else that is whole from 0.
            if a != b || (is_read && a < 0) {
                return Err(format!("twins read {a} and {b}"));
            }
        }
        Ok(())
    }

    pub(super) fn get_boolean(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let own = self.scene(slot).boolean;
        let references = self.references(slot, kind, vec![own], own, dice);
        let mut arrays = Arrays::new(kind, references, &[], -7, dice);
        let (function, rows) = (self.fmi.fmi2GetBoolean, &["fmi2GetBoolean"]);
        // SAFETY: as of reals.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            function(handle, arrays.references(), arrays.count, arrays.values(twin))
        })?;
        let strict = c_int::from(self.life(slot).strict);
        let is_read = status != ERROR && arrays.count > 0;
        if is_read && arrays.values.iter().any(|values| values[0] != strict) {
            return Err(format!("strict reads {:?}, not {strict}", arrays.values));
        }
        Ok(())
    }

    /// A value that goes with those of the other variables, whatever they are: near the start value.
    pub(super) fn near_start(&self, slot: usize, reference: u32, dice: &mut Dice) -> f64 {
        let scene = self.scene(slot);
        let start = scene.start[reference as usize];
        match start == 0.0 && scene.inputs.contains(&reference) {
            true => dice.between(-0.1, 0.1),
            false => start * dice.between(0.9, 1.1),
        }
    }

    pub(super) fn set_real(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let scene = self.scene(slot);
        let of = match kind {
            Kind::Input => &scene.inputs,
            Kind::Tunable => &scene.tunable,
            Kind::Fixed => &scene.fixed,
            Kind::Output => &scene.outputs,
            _ => &[&scene.inputs[..], &scene.tunable, &scene.fixed].concat(),
        };
        if of.is_empty() {
            return Ok(());
        }
        let good = Self::some(of, 4, dice);
        let mut references = self.references(slot, kind, good, scene.reals[0], dice);
        if kind == Kind::OutOfRange {
            references.push(dice.pick(&scene.bounded));
        }
        let value = |&reference: &u32, dice: &mut Dice| {
            let is_known = (reference as usize) < scene.start.len();
            if is_known { self.near_start(slot, reference, dice) } else { 1.0 }
        };
        let mut values: Vec<f64> = references.iter().map(|one| value(one, dice)).collect();
        let last = values.len() - 1;
        match kind {
            Kind::NotFinite => {
                values[last] = dice.pick(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY]);
            }
            Kind::OutOfRange => values[last] = dice.pick(&[-1.0, -1e300, -1e-9]),
            _ => {}
        }
        let mut rows = vec!["fmi2SetReal"];
        if kind != Kind::Empty {
            for (row, of) in [
                ("(input)", &scene.inputs),
                ("(tunable)", &scene.tunable),
                ("(fixed)", &scene.fixed),
                ("(output)", &scene.outputs),
            ] {
                rows.extend(references.iter().any(|one| of.contains(one)).then_some(row));
            }
        }
        let fit = match kind {
            Kind::Input | Kind::Tunable | Kind::Fixed | Kind::Output => Fit::Good,
            _ => fit_of(kind),
        };
        let mut arrays = Arrays::new(kind, references, &values, 0.0, dice);
        let function = self.fmi.fmi2SetReal;
        // SAFETY: as of reading.
        let status = self.call(slot, kind, &rows, fit, &mut |twin, handle| unsafe {
            function(handle, arrays.references(), arrays.count, arrays.values(twin))
        })?;
        if status != ERROR && kind != Kind::Empty {
            let life = self.life(slot);
            for (reference, value) in arrays.references.iter().zip(values) {
                life.values[*reference as usize] = value;
            }
        }
        Ok(())
    }

    /// All integers are outputs.
    pub(super) fn set_integer(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let scene = self.scene(slot);
        let good = Self::some(&scene.integers, 3, dice);
        let references = self.references(slot, kind, good, scene.integers[0], dice);
        let mut arrays = Arrays::new(kind, references, &[], 1, dice);
        let rows: &[_] = match kind {
            Kind::Empty => &["fmi2SetInteger"],
            _ => &["fmi2SetInteger", "(output)"],
        };
        let function = self.fmi.fmi2SetInteger;
        // SAFETY: as of reals.
        self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            function(handle, arrays.references(), arrays.count, arrays.values(twin))
        })?;
        Ok(())
    }

    /// The one Boolean is a fixed parameter.
    pub(super) fn set_boolean(
        &mut self,
        slot: usize,
        kind: Kind,
        references: &[u32],
        values: &[c_int],
        dice: &mut Dice,
    ) -> Check {
        let mut arrays = Arrays::new(kind, references.to_vec(), values, 1, dice);
        let rows: &[_] = match kind {
            Kind::Empty => &["fmi2SetBoolean"],
            _ => &["fmi2SetBoolean", "(fixed)"],
        };
        let function = self.fmi.fmi2SetBoolean;
        // SAFETY: as of reals.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            function(handle, arrays.references(), arrays.count, arrays.values(twin))
        })?;
        if status != ERROR && kind != Kind::Empty {
            self.life(slot).strict = values[0] != 0;
        }
        Ok(())
    }

    /// There are no strings: only none of them can be asked for.
    pub(super) fn strings(
        &mut self,
        slot: usize,
        name: &'static str,
        kind: Kind,
        dice: &mut Dice,
    ) -> Check {
        let references = Self::some(&self.scene(slot).reals, 3, dice);
        let mut arrays = Arrays::new(kind, references, &[], c"".as_ptr(), dice);
        let (get, set) = (self.fmi.fmi2GetString, self.fmi.fmi2SetString);
        // SAFETY: as of reals.
        self.call(slot, kind, &[name], fit_of(kind), &mut |twin, handle| unsafe {
            let (references, count, values) =
                (arrays.references(), arrays.count, arrays.values(twin));
            match name {
                "fmi2GetString" => get(handle, references, count, values),
                _ => set(handle, references, count, values),
            }
        })?;
        Ok(())
    }
}
