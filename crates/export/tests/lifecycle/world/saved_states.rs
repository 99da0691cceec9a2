//! Saved states.

use super::*;

impl World<'_> {
    /// Values that both twins read of all variables; `None` for an instance that is not yet in initialization.
    pub(super) fn read_all(&mut self, slot: usize) -> Check<Option<Vec<u64>>> {
        if self.life(slot).phase == Phase::Instantiated {
            return Ok(None);
        }
        let (scene, fmi) = (self.scene(slot), self.fmi);
        let mut read: [Vec<u64>; 2] = Default::default();
        let (reals, integers) = (&scene.reals, &scene.integers);
        let mut values = vec![0.0; reals.len()];
        // SAFETY: the handle is alive; the arrays are as long as said.
        self.call(slot, Kind::Good, &["fmi2GetReal"], Fit::Good, &mut |twin, handle| unsafe {
            let status =
                (fmi.fmi2GetReal)(handle, reals.as_ptr(), reals.len(), values.as_mut_ptr());
            read[twin].extend(values.iter().map(|value| value.to_bits()));
            status
        })?;
        let mut values = vec![0; integers.len()];
        // SAFETY: as above.
        self.call(slot, Kind::Good, &["fmi2GetInteger"], Fit::Good, &mut |twin, handle| unsafe {
            let (pointer, count) = (integers.as_ptr(), integers.len());
            let status = (fmi.fmi2GetInteger)(handle, pointer, count, values.as_mut_ptr());
            read[twin].extend(values.iter().map(|&value| u64::from(c_int::cast_unsigned(value))));
            status
        })?;
        let [a, b] = read;
        if a == b { Ok(Some(a)) } else { Err("the twins read different values".to_owned()) }
    }

    /// A state of a scene, saved now if there is none; its place among the states.
    pub(super) fn any_state(&mut self, slot: usize, dice: &mut Dice) -> Check<usize> {
        let scene = self.scene_of(slot);
        let is_here = |i: &usize| self.states[*i].saved.scene == scene;
        let known: Vec<usize> = (0..self.states.len()).filter(is_here).collect();
        if !known.is_empty() {
            return Ok(dice.pick(&known));
        }
        self.get_state(slot, Kind::Good, dice)
    }

    /// A slot of the other scene, with an instance.
    pub(super) fn other_slot(&mut self, slot: usize, dice: &mut Dice) -> Check<usize> {
        let last = usize::from(SLOTS) - 1;
        let other = if slot == last { dice.below(last) } else { last };
        if self.slots[other].is_none() {
            self.instantiate(other, Kind::Good, dice)?;
        }
        Ok(other)
    }

    pub(super) fn get_state(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check<usize> {
        if self.states.len() >= STATES {
            self.free_state(slot, Kind::Good, dice)?;
        }
        let read = if dice.one_in(2) { self.read_all(slot)? } else { None };
        let existing = match kind {
            Kind::Existing => Some(self.any_state(slot, dice)?),
            _ => None,
        };
        let mut handles = existing.map_or([ptr::null_mut(); 2], |i| self.states[i].handles);
        let before = handles;
        let function = self.fmi.fmi2GetFMUstate;
        let rows = &["fmi2GetFMUstate"];
        let fit = if kind == Kind::Existing { Fit::Good } else { fit_of(kind) };
        // SAFETY: the handle is NULL or alive; the place holds NULL or a state, or is not to be used.
        let status = self.call(slot, kind, rows, fit, &mut |twin, handle| unsafe {
            let place = &raw mut handles[twin];
            match kind {
                Kind::NullPointer => function(handle, ptr::null_mut()),
                Kind::Misaligned => function(handle, place.wrapping_byte_add(1)),
                _ => function(handle, place),
            }
        })?;
        if status == ERROR {
            let is_kept = handles == before;
            return if is_kept {
                Ok(0)
            } else {
                Err("a state was given in spite of it".to_owned())
            };
        }
        if handles.contains(&ptr::null_mut()) {
            return Err("no state was given".to_owned());
        }
        let (scene, life) = (self.scene_of(slot), self.life(slot).clone());
        let saved = Saved { scene, life, read };
        match existing {
            Some(i) if handles == before => self.states[i].saved = saved,
            Some(_) => return Err("an existing state was not written over".to_owned()),
            None => self.states.push(State { handles, saved }),
        }
        Ok(existing.unwrap_or(self.states.len() - 1))
    }

    /// The state that a kind is about: of this scene, of the other one, or none.
    pub(super) fn state_for(
        &mut self,
        slot: usize,
        kind: Kind,
        dice: &mut Dice,
    ) -> Check<Option<usize>> {
        Ok(match kind {
            Kind::NullState => None,
            Kind::OtherScene => {
                let other = self.other_slot(slot, dice)?;
                Some(self.any_state(other, dice)?)
            }
            _ => Some(self.any_state(slot, dice)?),
        })
    }

    pub(super) fn set_state(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let place = self.state_for(slot, kind, dice)?;
        let handles = place.map_or([ptr::null_mut(); 2], |i| self.states[i].handles);
        // From one twin into the other it leads to the same.
        let crossed = dice.below(2);
        let function = self.fmi.fmi2SetFMUstate;
        let rows = &["fmi2SetFMUstate"];
        // SAFETY: the handle is NULL or alive; so is the state.
        let status = self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            function(handle, handles[twin ^ crossed])
        })?;
        let Some(place) = place.filter(|_| status != ERROR) else { return Ok(()) };
        let saved = self.states[place].saved.clone();
        self.life(slot).restore(&saved.life);
        if let Some(read) = saved.read
            && self.read_all(slot)?.is_some_and(|now| now != read)
        {
            return Err("a restored state does not read as it did when it was saved".to_owned());
        }
        Ok(())
    }

    pub(super) fn free_state(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let mut place = None;
        if matches!(kind, Kind::Good | Kind::Twice) && !self.states.is_empty() {
            place = Some(dice.below(self.states.len()));
        }
        let mut handles =
            place.map_or([ptr::null_mut(); 2], |i| self.states.swap_remove(i).handles);
        let function = self.fmi.fmi2FreeFMUstate;
        let times = if kind == Kind::Twice { 2 } else { 1 };
        for _ in 0..times {
            // SAFETY: the handle is NULL or alive; so is the state, which is not used again.
            self.call(slot, kind, &["fmi2FreeFMUstate"], Fit::Good, &mut |twin, handle| unsafe {
                let place = &raw mut handles[twin];
                function(handle, if kind == Kind::NullPointer { ptr::null_mut() } else { place })
            })?;
            if handles != [ptr::null_mut(); 2] {
                return Err("a state that is freed is NULL".to_owned());
            }
        }
        Ok(())
    }

    pub(super) fn size(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let place = self.state_for(slot, kind, dice)?;
        let handles = place.map_or([ptr::null_mut(); 2], |i| self.states[i].handles);
        self.size_of(slot, kind, handles).map(|_| ())
    }

    pub(super) fn size_of(
        &mut self,
        slot: usize,
        kind: Kind,
        handles: [Handle; 2],
    ) -> Check<usize> {
        let mut sizes = [0_usize; 2];
        let function = self.fmi.fmi2SerializedFMUstateSize;
        let rows = &["fmi2SerializedFMUstateSize"];
        // SAFETY: the handle and the state are NULL or alive; the place has room, or is not to be used.
        self.call(slot, kind, rows, fit_of(kind), &mut |twin, handle| unsafe {
            let size = &raw mut sizes[twin];
            let size = match kind {
                Kind::NullPointer => ptr::null_mut(),
                Kind::Misaligned => size.wrapping_byte_add(1),
                _ => size,
            };
            function(handle, handles[twin], size)
        })?;
        if sizes[0] == sizes[1] { Ok(sizes[0]) } else { Err(format!("sizes {sizes:?}")) }
    }

    pub(super) fn serialize(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        let place = self.state_for(slot, kind, dice)?;
        let handles = place.map_or([ptr::null_mut(); 2], |i| self.states[i].handles);
        let size = match kind {
            Kind::NullState | Kind::OtherScene => 100,
            _ => self.size_of(slot, Kind::Good, handles)?,
        };
        let count = match kind {
            Kind::Longer => size + 1 + dice.below(100),
            Kind::Short => dice.below(size),
            Kind::Empty => 0,
            Kind::Huge => dice.pick(&[1 << 63, usize::MAX]),
            _ => size,
        };
        self.serialize_into(slot, kind, handles, size, count).map(|_| ())
    }

    /// The bytes of both twins' states, which are the same.
    pub(super) fn serialize_into(
        &mut self,
        slot: usize,
        kind: Kind,
        handles: [Handle; 2],
        size: usize,
        count: usize,
    ) -> Check<Vec<u8>> {
        let mut bytes = [vec![0xa5_u8; size + 101], vec![0xa5; size + 101]];
        let function = self.fmi.fmi2SerializeFMUstate;
        // A state of some bytes has no room in none.
        let fit = match kind {
            Kind::Longer => Fit::Good,
            Kind::Empty => Fit::Bad,
            _ => fit_of(kind),
        };
        let rows = &["fmi2SerializeFMUstate"];
        // SAFETY: the handle and the state are NULL or alive; there is room, or it is not to be used.
        let status = self.call(slot, kind, rows, fit, &mut |twin, handle| unsafe {
            let room = match kind {
                Kind::NullArray => ptr::null_mut(),
                _ => bytes[twin].as_mut_ptr(),
            };
            function(handle, handles[twin], room, count)
        })?;
        let [a, b] = &mut bytes;
        let written = if status == ERROR { 0 } else { size };
        if a != b || a[written..].iter().any(|&byte| byte != 0xa5) {
            return Err("the twins' bytes differ, or more is written than said".to_owned());
        }
        a.truncate(written);
        Ok(std::mem::take(a))
    }

    pub(super) fn deserialize(&mut self, slot: usize, kind: Kind, dice: &mut Dice) -> Check {
        if self.states.len() >= STATES {
            self.free_state(slot, Kind::Good, dice)?;
        }
        let place = self.state_for(slot, kind, dice)?.expect("there is one");
        let State { handles, saved } = &self.states[place];
        let (handles, saved) = (*handles, saved.clone());
        let from = if kind == Kind::OtherScene { self.other_slot(slot, dice)? } else { slot };
        let size = self.size_of(from, Kind::Good, handles)?;
        let mut bytes = self.serialize_into(from, Kind::Good, handles, size, size)?;
        match kind {
            Kind::Short => bytes.truncate(dice.below(size)),
            Kind::Longer => bytes.push(dice.below(256) as u8),
            Kind::Flipped => {
                let bit = dice.below(8 * size);
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
            Kind::Garbage => bytes.iter_mut().for_each(|byte| *byte = dice.below(256) as u8),
            _ => {}
        }
        let (pointer, count) = match kind {
            Kind::NullArray => (ptr::null(), size),
            Kind::Empty => (dice.pick(&[ptr::null(), bytes.as_ptr()]), 0),
            Kind::Huge => {
                (dice.pick(&[ptr::null(), bytes.as_ptr()]), dice.pick(&[1 << 63, usize::MAX]))
            }
            _ => (bytes.as_ptr(), bytes.len()),
        };
        let mut made: [Handle; 2] = [ptr::null_mut(); 2];
        let function = self.fmi.fmi2DeSerializeFMUstate;
        // No bytes are no state.
        let fit = if kind == Kind::Empty { Fit::Bad } else { fit_of(kind) };
        let rows = &["fmi2DeSerializeFMUstate"];
        // SAFETY: the handle is NULL or alive; the bytes are as many as said, or not to be read.
        let status = self.call(slot, kind, rows, fit, &mut |twin, handle| unsafe {
            let place = &raw mut made[twin];
            let place = match kind {
                Kind::NullPointer => ptr::null_mut(),
                Kind::Misaligned => place.wrapping_byte_add(1),
                _ => place,
            };
            function(handle, pointer, count, place)
        })?;
        if made.iter().any(|handle| handle.is_null() != (status == ERROR)) {
            return Err("a state is given where there is one, and only there".to_owned());
        }
        if status != ERROR {
            self.states.push(State { handles: made, saved });
        }
        Ok(())
    }
}
