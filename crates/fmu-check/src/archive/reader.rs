//! Reads a zip archive header by header. Most libraries hide the mistakes that the rules look for, such as a name that
//! occurs twice or a local header that differs from the central directory; rawzip gives both headers unchanged.

use flate2::read::DeflateDecoder;
use rawzip::extra_fields::{ExtraFieldId, ExtraFields};
use rawzip::{
    CompressionMethod, CreatorSystem, ErrorKind, ZipArchive, ZipArchiveEntryWayfinder,
    ZipFileHeaderRecord, ZipSliceArchive,
};
use std::collections::HashMap;
use std::io::{self, Read, Write};

/// Limit of the number of entries; no FMU has more.
const MOST_ENTRIES: u64 = 200_000;

/// An entry as the central directory describes it, with the result of reading its local header.
pub(crate) struct Entry {
    /// Name of the entry; bytes that are not UTF-8 are replaced.
    pub(crate) name: String,
    pub(super) is_utf8: bool,
    pub(super) is_encrypted: bool,
    pub(super) has_data_descriptor: bool,
    pub(super) method: CompressionMethod,
    /// Version of zip needed to extract the entry, in tenths: the greater value of both headers.
    pub(super) version: u8,
    /// Unix file type and permissions; `None` if the archive was not made on a Unix system.
    pub(super) mode: Option<u32>,
    pub(super) zip64: bool,
    pub(super) packed: u64,
    pub(crate) size: u64,
    /// Position of the content in the archive, or the mistake in the local header.
    content: Result<ZipArchiveEntryWayfinder, String>,
}

impl Entry {
    fn new(archive: &ZipSliceArchive<Vec<u8>>, central: &ZipFileHeaderRecord<'_>) -> Self {
        let name = central.file_path();
        let made_by_unix = central.version_made_by().creator_system() == CreatorSystem::UNIX;
        let mut entry = Self {
            name: String::from_utf8_lossy(name.as_bytes()).into_owned(),
            is_utf8: std::str::from_utf8(name.as_bytes()).is_ok(),
            is_encrypted: central.flags().is_encrypted(),
            has_data_descriptor: central.flags().has_data_descriptor(),
            method: central.compression_method(),
            version: version(archive, central.central_directory_offset() + 6),
            mode: made_by_unix.then_some(central.external_attributes() >> 16),
            zip64: is_zip64(central.extra_fields()),
            packed: central.compressed_size_hint(),
            size: central.uncompressed_size_hint(),
            content: Ok(central.wayfinder()),
        };
        if let Err(message) = entry.add_local_header(archive, central) {
            entry.content = Err(message);
        }
        entry
    }

    fn add_local_header(
        &mut self,
        archive: &ZipSliceArchive<Vec<u8>>,
        central: &ZipFileHeaderRecord<'_>,
    ) -> Result<(), String> {
        let content =
            archive.get_entry(central.wayfinder()).map_err(|error| match error.kind() {
                ErrorKind::Eof => "its header or its content lies outside the archive",
                _ => "it has no local header",
            })?;
        let local = content.local_header();
        if local.file_path() != central.file_path() {
            let other = String::from_utf8_lossy(local.file_path().as_bytes()).into_owned();
            return Err(format!("its local header names another file: {other}"));
        }
        if local.compression_method() != self.method {
            return Err(
                "its local and its central header state different compression methods".to_owned()
            );
        }
        self.version = self.version.max(version(archive, central.local_header_offset() + 4));
        self.is_encrypted |= local.flags().is_encrypted();
        self.has_data_descriptor |= local.flags().has_data_descriptor();
        self.zip64 |= is_zip64(local.extra_fields());
        // With a data descriptor the local header has no sizes.
        let stated = (local.crc32(), local.uncompressed_size_hint());
        if !local.flags().has_data_descriptor()
            && !self.zip64
            && stated != (central.crc32(), self.size)
        {
            return Err(
                "its local and its central header state different sizes or checksums".to_owned()
            );
        }
        Ok(())
    }

    pub(crate) fn is_folder(&self) -> bool {
        self.name.ends_with('/')
    }
}

/// Version of zip that an entry needs, in tenths; rawzip reads the field but does not return it.
fn version(archive: &ZipSliceArchive<Vec<u8>>, at: u64) -> u8 {
    bytes_at(archive, at).map_or(0, |[version]| version)
}

/// `true` if the directory has the stated size, which is not checked for zip64. rawzip accepts another size; importers
/// do not.
fn is_directory_as_stated(archive: &ZipSliceArchive<Vec<u8>>) -> bool {
    let end = archive.eocd_offset();
    let is_zip64 = bytes_at(archive, end.wrapping_sub(20)) == Some(*b"PK\x06\x07");
    let size = bytes_at(archive, end + 12).map(u32::from_le_bytes);
    is_zip64 || size.is_some_and(|size| archive.directory_offset() + u64::from(size) == end)
}

fn bytes_at<const N: usize>(archive: &ZipSliceArchive<Vec<u8>>, at: u64) -> Option<[u8; N]> {
    archive.get_ref().get(usize::try_from(at).ok()?..)?.first_chunk().copied()
}

fn is_zip64(mut fields: ExtraFields<'_>) -> bool {
    fields.any(|(id, _)| id == ExtraFieldId::ZIP64)
}

/// A zip archive in memory.
pub(crate) struct Archive {
    archive: ZipSliceArchive<Vec<u8>>,
    pub(crate) entries: Vec<Entry>,
    /// Index of the first entry of each name.
    places: HashMap<String, usize>,
}

impl Archive {
    /// Reads the headers of an archive.
    ///
    /// # Errors
    /// Returns the reason if the bytes are not a zip archive or the directory cannot be read.
    pub(crate) fn read(bytes: Vec<u8>) -> Result<Self, String> {
        let damaged = || "the directory of its zip archive is damaged or cut off".to_owned();
        let archive =
            ZipArchive::from_slice(bytes).map_err(|_| "it is not a zip archive".to_owned())?;
        let count = archive.entries_hint();
        if count > MOST_ENTRIES {
            return Err(format!("it states {count} entries; the limit is {MOST_ENTRIES}"));
        }
        if !is_directory_as_stated(&archive) {
            return Err(damaged());
        }
        let mut headers = archive.entries();
        let mut entries = Vec::new();
        for _ in 0..count {
            let header = headers.next().and_then(Result::ok).ok_or_else(damaged)?;
            entries.push(Entry::new(&archive, &header));
        }
        let mut places = HashMap::new();
        for (place, entry) in entries.iter().enumerate() {
            places.entry(entry.name.clone()).or_insert(place);
        }
        Ok(Self { archive, entries, places })
    }

    /// Size of the packed archive, bytes.
    pub(super) fn len(&self) -> u64 {
        self.archive.get_ref().len() as u64
    }

    /// Returns the first entry of this name.
    pub(crate) fn find(&self, name: &str) -> Option<&Entry> {
        self.places.get(name).map(|&place| &self.entries[place])
    }

    /// Unpacks an entry into `to`.
    ///
    /// # Errors
    /// Returns an error if the size, the checksum or the local header is wrong; bytes that were unpacked before the
    /// error are written.
    pub(crate) fn unpack(&self, entry: &Entry, to: &mut dyn Write) -> Result<(), String> {
        let place = entry.content.clone()?;
        let content = self.archive.get_entry(place).map_err(|error| error.to_string())?;
        let mut unpacked: Box<dyn Read> = match entry.method {
            CompressionMethod::STORE => Box::new(content.data()),
            CompressionMethod::DEFLATE => Box::new(DeflateDecoder::new(content.data())),
            method => {
                return Err(format!("its compression method {} is not supported", method.as_u16()));
            }
        };
        // The reader fails as soon as the content exceeds the stated size.
        io::copy(&mut content.verifying_reader(&mut unpacked), to)
            .map_err(|error| explain(&error))?;
        Ok(())
    }

    /// Returns the content of an entry of at most `limit` bytes.
    ///
    /// # Errors
    /// Returns an error if the entry is larger, or as described for [`Self::unpack`].
    pub(crate) fn content(&self, entry: &Entry, limit: u64) -> Result<Vec<u8>, String> {
        if entry.size > limit {
            return Err(format!("it has {} bytes; the limit is {limit}", entry.size));
        }
        let mut content = Vec::new();
        self.unpack(entry, &mut content)?;
        Ok(content)
    }
}

fn explain(error: &io::Error) -> String {
    let source = error.get_ref().and_then(|source| source.downcast_ref::<rawzip::Error>());
    match source.map(rawzip::Error::kind) {
        Some(ErrorKind::InvalidSize { expected, actual }) => {
            let more = if actual > expected { "more" } else { "fewer" };
            format!("it unpacks to {more} than the {expected} bytes that the archive states")
        }
        Some(ErrorKind::InvalidChecksum { expected, actual }) => {
            format!("its checksum is {actual:08x}, but the archive states {expected:08x}")
        }
        _ => format!("it cannot be unpacked: {error}"),
    }
}
