//! A zip archive header by header: what libraries smooth over (names twice, local headers that say
//! something else) is what is looked for here.

use crate::Error;
use flate2::read::DeflateDecoder;
use std::collections::HashMap;
use std::io::{self, Read, Write};

const END: &[u8] = b"PK\x05\x06";
const END_64: &[u8] = b"PK\x06\x06";
const LOCATOR_64: &[u8] = b"PK\x06\x07";
const CENTRAL: &[u8] = b"PK\x01\x02";
const LOCAL: &[u8] = b"PK\x03\x04";
/// More entries than any FMU has.
pub(super) const MOST_ENTRIES: u64 = 200_000;

/// One entry as the central directory has it, and what its local header says.
pub(crate) struct Entry {
    /// Its name; bytes that are not UTF-8 are replaced.
    pub(crate) name: String,
    pub(super) is_utf8: bool,
    pub(super) flags: u16,
    pub(super) method: u16,
    /// The greater one of both headers, in tenths.
    pub(super) version: u16,
    /// Unix's file type and permissions, where a Unix made the archive.
    pub(super) mode: Option<u32>,
    pub(super) zip64: bool,
    crc: u32,
    pub(super) packed: u64,
    pub(crate) size: u64,
    /// Where the content begins, or what is wrong with the local header.
    content: Result<usize, String>,
}

impl Entry {
    pub(crate) fn is_folder(&self) -> bool {
        self.name.ends_with('/')
    }
}

/// An archive in memory.
pub(crate) struct Archive {
    bytes: Vec<u8>,
    pub(crate) entries: Vec<Entry>,
    /// The first entry of each name.
    places: HashMap<String, usize>,
}

impl Archive {
    /// Reads the headers.
    ///
    /// # Errors
    /// It is not a zip archive, or its directory cannot be read.
    pub(crate) fn read(bytes: Vec<u8>) -> Result<Self, Error> {
        let damaged =
            || Error::new("not an FMU: the zip archive's directory is damaged or cut off");
        let end = end(&bytes).ok_or_else(|| Error::new("not an FMU: it is not a zip archive"))?;
        let count = end.count;
        if count > MOST_ENTRIES {
            return Err(Error::new(format!("not an FMU: it states {count} entries")));
        }
        let mut entries = Vec::new();
        let mut at = end.directory;
        for _ in 0..count {
            let (entry, next) = central(&bytes, at, end.shift).ok_or_else(damaged)?;
            entries.push(entry);
            at = next;
        }
        let mut places = HashMap::new();
        for (place, entry) in entries.iter().enumerate() {
            places.entry(entry.name.clone()).or_insert(place);
        }
        Ok(Self { bytes, entries, places })
    }

    /// The archive's own size in bytes.
    pub(super) fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// The entry of this name.
    pub(crate) fn find(&self, name: &str) -> Option<&Entry> {
        self.places.get(name).map(|&place| &self.entries[place])
    }

    /// Unpacks an entry.
    ///
    /// # Errors
    /// Its size, checksum or local header do not fit; what was unpacked until then is written.
    pub(crate) fn unpack(&self, entry: &Entry, to: &mut dyn Write) -> Result<(), String> {
        let start = entry.content.clone()?;
        let content = usize::try_from(entry.packed)
            .ok()
            .and_then(|packed| self.bytes.get(start..start.checked_add(packed)?))
            .ok_or("its content is cut off")?;
        // One byte more than stated is enough to know.
        let limit = entry.size.saturating_add(1);
        let mut sum = Sum { to, hasher: crc32fast::Hasher::new(), size: 0 };
        let copied = match entry.method {
            0 => io::copy(&mut content.take(limit), &mut sum),
            8 => io::copy(&mut DeflateDecoder::new(content).take(limit), &mut sum),
            method => return Err(format!("its compression (method {method}) is not known")),
        };
        copied.map_err(|error| format!("it does not unpack: {error}"))?;
        if sum.size != entry.size {
            let more = if sum.size > entry.size { "more" } else { "fewer" };
            return Err(format!(
                "it unpacks to {more} than the {} bytes that it states",
                entry.size
            ));
        }
        let crc = sum.hasher.finalize();
        if crc != entry.crc {
            return Err(format!("its checksum is {crc:08x}, stated is {:08x}", entry.crc));
        }
        Ok(())
    }

    /// The content of an entry of at most `limit` bytes.
    ///
    /// # Errors
    /// As of [`Self::unpack`]; it is larger.
    pub(crate) fn content(&self, entry: &Entry, limit: u64) -> Result<Vec<u8>, String> {
        if entry.size > limit {
            return Err(format!("it has {} bytes; the limit is {limit}", entry.size));
        }
        let mut content = Vec::new();
        self.unpack(entry, &mut content)?;
        Ok(content)
    }
}

/// Sums up what is written on its way.
struct Sum<'a> {
    to: &'a mut dyn Write,
    hasher: crc32fast::Hasher,
    size: u64,
}

impl Write for Sum<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.to.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        self.size += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.to.flush()
    }
}

// ---- Headers ----

struct End {
    count: u64,
    directory: usize,
    /// What stands before the archive in the file.
    shift: usize,
}

fn end(bytes: &[u8]) -> Option<End> {
    let first = bytes.len().saturating_sub(22 + 0xffff);
    let at = (first..=bytes.len().checked_sub(22)?).rev().find(|&at| {
        bytes[at..].starts_with(END)
            && at + 22 + usize::from(short(bytes, at + 20).unwrap_or(0)) <= bytes.len()
    })?;
    let mut place = at;
    let mut count = u64::from(short(bytes, at + 10)?);
    let mut size = u64::from(long(bytes, at + 12)?);
    let mut offset = u64::from(long(bytes, at + 16)?);
    let locator = at.checked_sub(20).filter(|&locator| bytes[locator..].starts_with(LOCATOR_64));
    if let Some(locator) = locator {
        place = usize::try_from(wide(bytes, locator + 8)?).ok()?;
        bytes.get(place..)?.starts_with(END_64).then_some(())?;
        count = wide(bytes, place + 32)?;
        size = wide(bytes, place + 40)?;
        offset = wide(bytes, place + 48)?;
    }
    let stated = usize::try_from(offset.checked_add(size)?).ok()?;
    let shift = place.checked_sub(stated)?;
    Some(End { count, directory: usize::try_from(offset).ok()? + shift, shift })
}

fn central(bytes: &[u8], at: usize, shift: usize) -> Option<(Entry, usize)> {
    bytes.get(at..)?.starts_with(CENTRAL).then_some(())?;
    let name_end = at + 46 + usize::from(short(bytes, at + 28)?);
    let extra_end = name_end + usize::from(short(bytes, at + 30)?);
    let next = extra_end + usize::from(short(bytes, at + 32)?);
    let raw = bytes.get(at + 46..name_end)?;
    let extra = bytes.get(name_end..extra_end)?;
    let mut packed = u64::from(long(bytes, at + 20)?);
    let mut size = u64::from(long(bytes, at + 24)?);
    let mut offset = u64::from(long(bytes, at + 42)?);
    let mut zip64 = false;
    if let Some(field) = field_64(extra) {
        zip64 = true;
        let mut values = field.as_chunks::<8>().0.iter().map(|value| u64::from_le_bytes(*value));
        for value in [&mut size, &mut packed, &mut offset] {
            if *value == u64::from(u32::MAX) {
                *value = values.next()?;
            }
        }
    }
    let made_by_unix = short(bytes, at + 4)? >> 8 == 3;
    let mut entry = Entry {
        name: String::from_utf8_lossy(raw).into_owned(),
        is_utf8: std::str::from_utf8(raw).is_ok(),
        flags: short(bytes, at + 8)?,
        method: short(bytes, at + 10)?,
        version: short(bytes, at + 6)? & 0xff,
        mode: made_by_unix.then_some(long(bytes, at + 38)? >> 16),
        zip64,
        crc: long(bytes, at + 16)?,
        packed,
        size,
        content: Err(String::new()),
    };
    entry.content = match usize::try_from(offset).ok().and_then(|offset| offset.checked_add(shift))
    {
        Some(start) => local(bytes, start, raw, &mut entry),
        None => Err("its place is outside the archive".to_owned()),
    };
    Some((entry, next))
}

/// Where the content begins behind the local header.
fn local(bytes: &[u8], at: usize, name: &[u8], entry: &mut Entry) -> Result<usize, String> {
    let read = || {
        bytes.get(at..)?.starts_with(LOCAL).then_some(())?;
        let name_end = at + 30 + usize::from(short(bytes, at + 26)?);
        let content = name_end + usize::from(short(bytes, at + 28)?);
        Some((bytes.get(at + 30..name_end)?, bytes.get(name_end..content)?, content))
    };
    let (local_name, extra, content) = read().ok_or("it has no local header")?;
    let number = |offset| short(bytes, at + offset).unwrap_or(0);
    if local_name != name {
        let other = String::from_utf8_lossy(local_name);
        return Err(format!("its local header names another file: {other}"));
    }
    if number(8) != entry.method {
        return Err("its two headers state two ways of compression".to_owned());
    }
    entry.version = entry.version.max(number(4) & 0xff);
    entry.flags |= number(6);
    entry.zip64 |= field_64(extra).is_some();
    // With a data descriptor the local header has no sizes.
    let stated = (long(bytes, at + 14), long(bytes, at + 22).map(u64::from));
    if number(6) & 8 == 0 && !entry.zip64 && stated != (Some(entry.crc), Some(entry.size)) {
        return Err("its two headers state two sizes or checksums".to_owned());
    }
    Ok(content)
}

/// The zip64 field among the extra fields.
fn field_64(mut extra: &[u8]) -> Option<&[u8]> {
    while let (Some(id), Some(length)) = (short(extra, 0), short(extra, 2)) {
        let field = extra.get(4..4 + usize::from(length))?;
        if id == 1 {
            return Some(field);
        }
        extra = &extra[4 + field.len()..];
    }
    None
}

fn short(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?))
}

fn long(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

fn wide(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(bytes.get(at..at.checked_add(8)?)?.try_into().ok()?))
}
