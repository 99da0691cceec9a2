//! Random numbers that a seed determines.

/// SplitMix64: every seed gives a good sequence of its own.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The sequence of one scene of a run; neighbouring scenes and seeds have nothing in common.
    pub fn of(seed: u64, scene: u64) -> Self {
        let mut mixed = Self(seed);
        let offset = mixed.next();
        Self(offset ^ scene.wrapping_mul(0xd134_2543_de82_ef95))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From 0 up to 1.
    pub fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.unit()
    }

    /// A number between two of the same sign; each order of magnitude between them is as likely.
    pub fn wide(&mut self, from: f64, to: f64) -> f64 {
        self.between(from.ln(), to.ln()).exp()
    }

    /// A number of either sign whose magnitude is between these; each order of magnitude is as likely.
    pub fn signed(&mut self, from: f64, to: f64) -> f64 {
        let size = self.wide(from, to);
        if self.chance(0.5) { size } else { -size }
    }

    /// A whole number, both ends included.
    pub fn whole(&mut self, from: usize, to: usize) -> usize {
        from + (self.next() % (to - from + 1) as u64) as usize
    }

    pub fn chance(&mut self, part: f64) -> bool {
        self.unit() < part
    }

    /// A value with this chance, else none.
    pub fn sometimes<T>(&mut self, part: f64, make: impl FnOnce(&mut Self) -> T) -> Option<T> {
        let is_there = self.chance(part);
        is_there.then(|| make(self))
    }
}
