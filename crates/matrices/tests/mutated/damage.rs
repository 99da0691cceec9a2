//! Damage to the content of files.

/// Random numbers: SplitMix64.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.next() % end as u64) as usize }
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }
}

/// Numbers that readers may stumble over.
const NUMBERS: [&str; 16] = [
    "0",
    "-1",
    "1",
    "2",
    "13",
    "255",
    "65536",
    "2147483648",
    "4294967295",
    "9223372036854775807",
    "18446744073709551615",
    "99999999999999999999999",
    "1e999",
    "NaN",
    "1.5+103",
    "-",
];

/// Damages a content in one place. `other` is a content to take pieces from.
pub fn damage(content: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    let at = random.below(content.len());
    let end = at + random.below(content.len() - at).min(random.one_of(&[1, 4, 8, 64, usize::MAX]));
    // Most damage leaves the length, since the readers of binary files refuse another one at once.
    match random.below(14) {
        0 => content.truncate(at),
        1 => drop(content.drain(at..end)),
        2 | 10 => content[at..end].iter_mut().for_each(|byte| *byte = random.next() as u8),
        3 => content[at..end].fill(random.one_of(&[0, 1, 0x7f, 0x80, 0xff, b' ', b'\n', b'9'])),
        4 => {
            let piece = content[at..end].to_vec();
            let target = random.below(content.len());
            content.splice(target..target, piece);
        }
        5 => {
            let from = random.below(other.len());
            let piece = &other[from..][..random.below(other.len() - from)];
            content.splice(at..end, piece.iter().copied());
        }
        6 | 11..=13 => {
            let number = random.one_of(&[
                0,
                1,
                0x7fff_ffff,
                u64::from(u32::MAX),
                u64::MAX >> 1,
                u64::MAX,
                1 << 33,
            ]);
            let bytes =
                if random.below(2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
            let size = random.one_of(&[2, 4, 8]);
            content.iter_mut().skip(at).zip(&bytes[..size]).for_each(|(byte, new)| *byte = *new);
        }
        7 => {
            // The number of text at or after this place.
            let Some(start) = content[at..].iter().position(u8::is_ascii_digit) else { return };
            let start = at + start;
            let digits = content[start..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            let number = random.one_of(&NUMBERS);
            content.splice(start..start + digits, number.bytes());
        }
        _ => {
            // A line is left out or repeated.
            let start =
                content[..at].iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
            let length = content[start..].iter().position(|&byte| byte == b'\n');
            let line = start..length.map_or(content.len(), |length| start + length + 1);
            let repeated =
                if random.below(2) == 0 { content[line.clone()].repeat(2) } else { Vec::new() };
            content.splice(line, repeated);
        }
    }
    // Splices must not let it grow without end.
    content.truncate(1 << 16);
}
