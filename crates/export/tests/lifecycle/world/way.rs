//! The dispatch of a drawn call to an instance.

use super::*;

impl World<'_> {
    pub(super) fn perform(&mut self, op: &Op) -> Check {
        let (slot, mut dice) = (usize::from(op.slot), Dice(op.seed));
        if self.slots[slot].is_none() {
            self.instantiate(slot, Kind::Good, &mut dice)?;
        }
        if let Some(strict) = op.strict.filter(|&strict| strict != self.life(slot).strict) {
            self.reset(slot, strict)?;
        }
        if let Some(phase) = op.phase {
            self.go(slot, phase, &mut dice)?;
        }
        let Life { phase, strict, .. } = *self.life(slot);
        if dice.one_in(4) {
            self.disturb(slot)?;
        }
        self.make(slot, op, &mut dice)?;
        self.tally.met.insert((op.function, op.kind, phase, strict));
        Ok(())
    }

    /// Back to the beginning, strict or not.
    pub(super) fn reset(&mut self, slot: usize, strict: bool) -> Check {
        self.alone(slot, Kind::Good, &["fmi2Reset"])?;
        self.set_strict(slot, strict)
    }

    pub(super) fn set_strict(&mut self, slot: usize, strict: bool) -> Check {
        let value = c_int::from(strict);
        self.set_boolean(slot, Kind::Good, &[self.scene(slot).boolean], &[value], &mut Dice(0))?;
        Ok(())
    }

    /// The way from one phase to another that no host can go wrong on; for the error phase one that none can
    /// go right on.
    pub(super) fn go(&mut self, slot: usize, target: Phase, dice: &mut Dice) -> Check {
        let Life { phase, strict, .. } = *self.life(slot);
        if phase != target && target == Phase::Error {
            return self.do_step(slot, Kind::NotFinite, dice);
        }
        if phase > target {
            self.reset(slot, strict)?;
        }
        while self.life(slot).phase != target {
            match self.life(slot).phase {
                Phase::Instantiated => {
                    if dice.one_in(3) {
                        self.set_real(slot, Kind::Fixed, dice)?;
                    }
                    self.setup_experiment(slot, Kind::Good, dice)?;
                    self.alone(slot, Kind::Good, &["fmi2EnterInitializationMode"])?;
                }
                Phase::Initialization => {
                    if dice.one_in(3) {
                        self.set_real(slot, Kind::Good, dice)?;
                    }
                    self.alone(slot, Kind::Good, &["fmi2ExitInitializationMode"])?;
                    if dice.one_in(2) {
                        self.do_step(slot, Kind::Good, dice)?;
                    }
                }
                _ => {
                    self.alone(slot, Kind::Good, &["fmi2Terminate"])?;
                }
            }
        }
        Ok(())
    }

    pub(super) fn make(&mut self, slot: usize, op: &Op, dice: &mut Dice) -> Check {
        let kind = op.kind;
        match op.function {
            "fmi2GetTypesPlatform" | "fmi2GetVersion" => self.inquire(op.function),
            "fmi2SetDebugLogging" => self.set_debug_logging(slot, kind, dice),
            "fmi2Instantiate" => self.instantiate(slot, kind, dice),
            "fmi2FreeInstance" => {
                self.free_instance(slot, kind);
                Ok(())
            }
            "fmi2SetupExperiment" => self.setup_experiment(slot, kind, dice),
            "fmi2EnterInitializationMode" => {
                let Life { phase, strict, is_set_up, .. } = *self.life(slot);
                if phase == Phase::Instantiated && kind == Kind::Unprepared {
                    self.reset(slot, strict)?;
                } else if phase == Phase::Instantiated && !is_set_up {
                    self.setup_experiment(slot, Kind::Good, dice)?;
                }
                let is_set_up = self.life(slot).is_set_up;
                let rows: &[_] = if is_set_up || phase != Phase::Instantiated {
                    &["fmi2EnterInitializationMode"]
                } else {
                    &["fmi2EnterInitializationMode", "(without-experiment)"]
                };
                self.alone(slot, kind, rows).map(|_| ())
            }
            "fmi2ExitInitializationMode" | "fmi2Terminate" | "fmi2Reset" | "fmi2CancelStep" => {
                self.alone(slot, kind, &[op.function]).map(|_| ())
            }
            "fmi2GetReal" => self.get_real(slot, kind, dice),
            "fmi2GetInteger" => self.get_integer(slot, kind, dice),
            "fmi2GetBoolean" => self.get_boolean(slot, kind, dice),
            "fmi2SetReal" => self.set_real(slot, kind, dice),
            "fmi2SetInteger" => self.set_integer(slot, kind, dice),
            "fmi2SetBoolean" => {
                let own = self.scene(slot).boolean;
                let references = self.references(slot, kind, vec![own], own, dice);
                let strict = c_int::from(dice.one_in(2));
                self.set_boolean(slot, kind, &references, &[strict], dice)
            }
            "fmi2GetString" | "fmi2SetString" => self.strings(slot, op.function, kind, dice),
            "fmi2GetFMUstate" => self.get_state(slot, kind, dice).map(|_| ()),
            "fmi2SetFMUstate" => self.set_state(slot, kind, dice),
            "fmi2FreeFMUstate" => self.free_state(slot, kind, dice),
            "fmi2SerializedFMUstateSize" => self.size(slot, kind, dice),
            "fmi2SerializeFMUstate" => self.serialize(slot, kind, dice),
            "fmi2DeSerializeFMUstate" => self.deserialize(slot, kind, dice),
            "fmi2GetDirectionalDerivative" => self.directional_derivative(slot, kind, dice),
            "fmi2GetRealOutputDerivatives" => self.output_derivatives(slot, kind, dice),
            "fmi2SetRealInputDerivatives" => self.input_derivatives(slot, kind, dice),
            "fmi2DoStep" => self.do_step(slot, kind, dice),
            _ => self.status(slot, op.function, kind, dice),
        }
    }
}
